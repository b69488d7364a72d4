#include "hqslam/core/npy.h"

#include <cstring>

#include "testing.h"

using namespace hqslam;
using namespace hqslam::test;

namespace {

/// An .npy file put together by hand, as numpy's format document describes it.
std::string npy_file(const std::string& dictionary, const std::string& data, char version = 1) {
  std::string file("\x93NUMPY", 6);
  file += version;
  file += '\0';
  const std::size_t length = dictionary.size() + 1;
  file += static_cast<char>(length & 0xFF);
  file += static_cast<char>(length >> 8);
  if (version > 1) file += std::string(2, '\0');
  return file + dictionary + "\n" + data;
}

std::string bytes_of(const std::vector<float>& values) {
  std::string bytes(values.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

constexpr const char* kTwoImages = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1, 3), }";

std::string npy_complaint(const std::string& contents) {
  const TemporaryDirectory directory;
  write_file(directory.file("scans.npy"), contents);
  return error_message([&] { NpyStackReader reader(directory.file("scans.npy")); });
}

}  // namespace

TEST_CASE("an .npy stack written by hand is read image by image in any order") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("scans.npy");
  for (const char version : {'\1', '\2', '\3'}) {
    write_file(path, npy_file(kTwoImages, bytes_of({1, 2, 3, 4, 5, 6}), version));
    NpyStackReader reader(path);
    REQUIRE(reader.images() == 2);
    CHECK(reader.rows() == 1);
    CHECK(reader.columns() == 3);
    CHECK(reader.read(1).range_m == std::vector<float>{4, 5, 6});
    CHECK(reader.read(0).range_m == std::vector<float>{1, 2, 3});
    CHECK(refused_with([&] { reader.read(2); }, path, "0 to 1", "found 2"));
  }
}

TEST_CASE("a trailing axis of one and other spellings of the header mean the same") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("scans.npy");
  write_file(path, npy_file("{\"shape\":(1,2,2,1),\"descr\":\"<f4\",\"fortran_order\":False}   ",
                            bytes_of({1, 2, 3, 4})));
  NpyStackReader reader(path);
  CHECK(reader.rows() == 2);
  CHECK(reader.columns() == 2);
  CHECK(reader.read(0).at(1, 0) == 3.0F);
}

TEST_CASE("a stack is a valid .npy file after every image that is appended") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("scans.npy");
  NpyStackWriter writer(path, 2, 3);
  CHECK(NpyStackReader(path).images() == 0);
  for (int i = 0; i < 12; ++i) {
    RangeImage image(2, 3);
    image.at(1, 2) = static_cast<float>(i) + 0.25F;
    writer.append(image);
    NpyStackReader reader(path);
    REQUIRE(reader.images() == i + 1);
    CHECK(reader.read(i).range_m == image.range_m);
    CHECK(reader.read(0).at(1, 2) == 0.25F);
  }
  CHECK(file_contents(path).size() == 128 + 12 * 2 * 3 * sizeof(float));
  CHECK(refused_with([&] { writer.append(RangeImage(3, 2)); }, path, "2 x 3", "3 x 2"));
}

TEST_CASE("what an interrupted append leaves behind the last image is not read") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("scans.npy");
  write_file(path, npy_file(kTwoImages, bytes_of({1, 2, 3, 4, 5, 6}) + "half an im"));
  CHECK(NpyStackReader(path).images() == 2);
}

TEST_CASE("an array of doubles has numpy's header, byte for byte") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("poses.npy");
  NpyArrayWriter<double> writer(path, {2, 7});
  std::vector<double> item(14);
  item[13] = 1.5;
  writer.append(item);
  const std::string contents = file_contents(path);
  std::string expected("\x93NUMPY\x01\x00\x76\x00", 10);
  expected += "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2, 7), }";
  expected.resize(127, ' ');
  expected += '\n';
  CHECK(contents.substr(0, 128) == expected);
  REQUIRE(contents.size() == 128 + 14 * sizeof(double));
  double last = 0.0;
  std::memcpy(&last, contents.data() + 128 + 13 * sizeof(double), sizeof(double));
  CHECK(last == 1.5);
  CHECK(refused_with([&] { writer.append(std::vector<double>(13)); }, path, "14", "13"));
}

TEST_CASE("a file that is no stack of range images is refused in one line that says why") {
  const std::string data = bytes_of({1, 2, 3, 4, 5, 6});
  const auto with = [&](const std::string& dictionary) {
    return npy_complaint(npy_file(dictionary, data));
  };
  CHECK(one_line_with(npy_complaint("x y z\n1 2 3\n"), "scans.npy", "NUMPY"));
  CHECK(one_line_with(npy_complaint(""), "scans.npy", "NUMPY"));
  CHECK(one_line_with(npy_complaint(npy_file(kTwoImages, data, 9)), "9.0"));
  CHECK(one_line_with(npy_complaint(npy_file(kTwoImages, data).substr(0, 40)), "truncated"));
  CHECK(one_line_with(npy_complaint(npy_file(kTwoImages, data.substr(0, 23))), "truncated",
                      "2 images of 12 bytes", "found 23"));
  CHECK(one_line_with(npy_complaint(npy_file(kTwoImages, data + data)), "too long"));
  CHECK(one_line_with(with("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1, 3), }"),
                      "'<f4'", "'<f8'", "astype"));
  CHECK(one_line_with(with("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 1, 3), }"),
                      "Fortran"));
  CHECK(one_line_with(with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }"),
                      "(N, rows, columns)", "(2, 3)"));
  CHECK(one_line_with(with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 0, 3), }"),
                      "(2, 0, 3)"));
  CHECK(one_line_with(with("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (6,), }"),
                      "structures"));
}

TEST_CASE("sizes that overflow or exceed the file are refused before anything is allocated") {
  const auto with_shape = [](const std::string& shape) {
    return npy_complaint(npy_file(
        "{'descr': '<f4', 'fortran_order': False, 'shape': " + shape + ", }", bytes_of({1, 2, 3})));
  };
  CHECK(one_line_with(with_shape("(4611686018427387904, 1, 4)"), "truncated"));
  CHECK(one_line_with(with_shape("(99999999999999999999, 1, 3)"), "below 2^63"));
  CHECK(one_line_with(with_shape("(1, 4294967296, 4294967296)"), "4294967296"));
  CHECK(one_line_with(with_shape("(-1, 1, 3)"), "size"));
  CHECK(one_line_with(with_shape("(1, 65536, 65536)"), "truncated"));
}

TEST_CASE("a header that is no dictionary of the three keys is refused") {
  for (const char* dictionary :
       {"", "{", "{}", "{'descr': '<f4'", "{'descr': '<f4', 'fortran_order': False}",
        "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1)}",
        "{'descr': '<f4', 'fortran_order': 1, 'shape': (1, 1, 1)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1)} more",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1), 'x': 1}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': [1, 1, 1]}", "{'descr"}) {
    CAPTURE(dictionary);
    CHECK(one_line_with(npy_complaint(npy_file(dictionary, bytes_of({1}))), "scans.npy",
                        "damaged .npy header", "expected"));
  }
}
