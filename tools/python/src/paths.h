#pragma once

#include <nanobind/nanobind.h>

#include <filesystem>

/// Paths that come in: nanobind's own caster names their type without the argument that
/// `mypy --strict` asks for.
template <>
struct nanobind::detail::type_caster<std::filesystem::path> {
  NB_TYPE_CASTER(std::filesystem::path, const_name("str | os.PathLike[str]"))

  bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept {
    PyObject* bytes = nullptr;
    if (PyUnicode_FSConverter(given.ptr(), &bytes) == 0) {
      PyErr_Clear();
      return false;
    }
    value = PyBytes_AsString(bytes);
    Py_DECREF(bytes);
    return true;
  }
};
