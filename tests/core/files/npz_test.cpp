#include "hqslam/core/npz.h"

#include "golden_folder.h"
#include "testing.h"
#include "zip_by_hand.h"

namespace {

/// Deflate's blocks of plain bytes suffice for one that is short.
HandMember deflated(const std::string& contents) {
  HandMember member = stored(contents);
  member.method = 8;
  member.packed = std::string("\x01", 1) + little_endian(contents.size(), 2) +
                  little_endian(~contents.size() & 0xFFFF, 2) + contents;
  return member;
}

const std::string kFourBytes = "\x01\x02\x03\x04";

void refuses_npz(const std::string& npz, const auto&... parts) {
  const auto read = [](const auto& path) { return read_npz(path, 1 << 20); };
  const std::string complaint = error_message([&] { from_file("arrays.npz", npz, read); });
  CAPTURE(complaint);
  CHECK(one_line_with(complaint, parts...));
}
void refuses_npz(const HandMember& member, const auto&... parts) {
  refuses_npz(zip_of({member}), parts...);
}

NpzArrays some_arrays() {
  NpzArrays arrays;
  arrays["weights"] = npz_array(std::vector<float>{1.5F, -2.0F, 0.1F, 7, 8, 9}, {2, 3});
  arrays["loss"] = npz_array(std::vector<double>{0.1}, {});
  arrays["steps"] = npz_array(std::vector<std::int64_t>{-1, 1LL << 62}, {2});
  arrays["none"] = npz_array(std::vector<float>{}, {0, 3});
  arrays["text"] = npz_text("Grüße\n");
  arrays["layers.0.bias"] = {"|i1", {2}, {std::byte{0x80}, std::byte{0x7F}}};
  return arrays;
}

void check_equal(const NpzArrays& found, const NpzArrays& expected) {
  REQUIRE(found.size() == expected.size());
  for (const auto& [name, array] : expected) {
    CAPTURE(name);
    REQUIRE(found.count(name) == 1);
    CHECK(found.at(name).dtype == array.dtype);
    CHECK(found.at(name).shape == array.shape);
    CHECK(found.at(name).bytes == array.bytes);
  }
}

}  // namespace

TEST_CASE("arrays that are written come back with dtype, shape and bytes") {
  const TemporaryDirectory directory;
  write_npz(directory.file("arrays.npz"), some_arrays());
  const NpzArrays arrays = read_npz(directory.file("arrays.npz"));
  check_equal(arrays, some_arrays());
  CHECK(float_values(arrays.at("weights"), "weights")[1] == -2.0F);
  CHECK(double_values(arrays.at("loss"), "loss") == std::vector<double>{0.1});
  CHECK(int64_values(arrays.at("steps"), "steps") == std::vector<std::int64_t>{-1, 1LL << 62});
  CHECK(text_value(arrays.at("text"), "text") == "Grüße\n");
  CHECK(arrays.at("loss").elements() == 1);
  CHECK(arrays.at("weights").elements() == 6);
  CHECK(arrays.at("none").elements() == 0);
  write_file(directory.file("arrays.npz"), zip_of({}));
  CHECK(read_npz(directory.file("arrays.npz")).empty());
}

TEST_CASE("numpy's files are read, stored and deflated, with every dtype") {
  const auto bytes_of = [](std::initializer_list<int> values) {
    std::vector<std::byte> bytes;
    for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
    return bytes;
  };
  for (const char* name : {"numpy_stored.npz", "numpy_deflated.npz"}) {
    CAPTURE(name);
    NpzArrays arrays = read_npz(golden_folder() + "/" + name);
    CHECK(arrays.erase("nested/näme") == 1);
    CHECK(arrays.at("ramp").shape == std::vector<std::int64_t>{3, 10, 100});
    CHECK(float_values(arrays.at("ramp"), "ramp")[2999] == 49.0F);
    arrays.erase("ramp");
    check_equal(
        arrays,
        {{"float32", npz_array(std::vector{0.5F, -1.25F, 3.0F, INFINITY, 1e-40F, -0.0F}, {2, 3})},
         {"float64", npz_array(std::vector{0.1, -1e300}, {2})},
         {"int64", npz_array(std::vector<std::int64_t>{-1, 1LL << 62}, {2, 1})},
         {"int32", {"<i4", {2}, bytes_of({0, 0, 0, 0x80, 7, 0, 0, 0})}},
         {"uint8", npz_text("Grüße")},
         {"int8", {"|i1", {2}, bytes_of({0x80, 0x7F})}},
         {"bool", {"|b1", {3}, bytes_of({1, 0, 1})}},
         {"scalar", npz_array(std::vector<std::int64_t>{42}, {})},
         {"empty", npz_array(std::vector<float>{}, {0, 3})}});
  }
}

TEST_CASE("the same arrays give the same bytes, whatever the time zone") {
  const TemporaryDirectory directory;
  write_npz(directory.file("one.npz"), some_arrays());
  const char* zone = std::getenv("TZ");
  const std::string previous = zone == nullptr ? "" : zone;
  setenv("TZ", "Pacific/Auckland", 1);
  write_npz(directory.file("two.npz"), some_arrays());
  zone == nullptr ? unsetenv("TZ") : setenv("TZ", previous.c_str(), 1);
  const std::string contents = file_contents(directory.file("one.npz"));
  CHECK(contents == file_contents(directory.file("two.npz")));
  // The first member is the first by name, deflated, of 1980-01-01 00:00.
  CHECK(contents.substr(8, 6) == std::string("\x08\x00\x00\x00\x21\x00", 6));
  CHECK(contents.substr(30, 17) == "layers.0.bias.npy");
}

TEST_CASE("values that do not fit the shape, or of another dtype or size, are refused by name") {
  const std::vector<float> two{1, 2};
  CHECK(refused_with([&] { npz_array(two, {3}); }, "expected 3 values", "(3,)", "found 2"));
  CHECK(refused_with([] { npz_array(std::vector<float>{}, {-1, 0}); }, "negative", "(-1, 0)"));
  CHECK(refused_with([] { npz_array(std::vector<double>{}, {1LL << 40, 1LL << 40}); }, "2^59"));
  const NpzArray array = npz_array(two, {2, 1});
  CHECK(refused_with([&] { double_values(array, "bias"); }, "bias", "'<f8'", "'<f4'"));
  CHECK(refused_with([&] { int64_values(array, "bias"); }, "bias", "'<i8'"));
  CHECK(refused_with([&] { text_value(array, "bias"); }, "bias", "'|u1'"));
  NpzArray cut = array;
  cut.bytes.pop_back();
  CHECK(refused_with([&] { float_values(cut, "bias"); }, "bias", "8 bytes", "found 7"));
  const NpzArray square = {"|u1", {1, 1}, {std::byte{65}}};
  CHECK(refused_with([&] { text_value(square, "note"); }, "note", "one-dimensional", "(1, 1)"));
}

TEST_CASE("what is no zip archive is refused") {
  const TemporaryDirectory directory;
  const auto read = [&](const std::string& path) { return error_message([&] { read_npz(path); }); };
  CHECK(one_line_with(read(directory.file("none.npz")), "none.npz", "no file"));
  CHECK(one_line_with(read(directory.path()), "a folder"));
  refuses_npz("", "arrays.npz", "expected an .npz file");
  refuses_npz("x y z\n1 2 3\n", "expected an .npz file");
  refuses_npz(npy_file("'<f4'", "(1,)", kFourBytes), "expected an .npz file");
}

TEST_CASE("a member that numpy would not have written is refused by name") {
  const std::string array = npy_file("'|u1'", "(4,)", kFourBytes);
  for (const char* name : {"a.txt", "folder/", ".npy", "a.npy.bak"}) {
    CAPTURE(name);
    refuses_npz(stored(array, name), "arrays.npz", name, "a name that ends in .npy");
  }
  refuses_npz(stored(array, "line\nbreak"), "line\\nbreak");
  refuses_npz(zip_of({stored(array), stored(array)}), "'a.npy'", "every name once");
  HandMember member = stored(array);
  member.flags = 1;
  refuses_npz(member, "'a.npy'", "no encryption");
  member = stored(array);
  member.method = 12;  // bzip2
  refuses_npz(member, "'a.npy'", "stored or deflated", "method 12");
  refuses_npz(stored("no array"), "'a.npy'", "NUMPY");
  refuses_npz(stored(array.substr(0, 30)), "'a.npy'", "truncated");
}

TEST_CASE("an array that hqslam does not read is refused by member and reason") {
  const auto refuses = [](const char* dtype, const char* shape, const auto&... parts) {
    refuses_npz(deflated(npy_file(dtype, shape, kFourBytes)), parts...);
  };
  refuses("'<f2'", "(2,)", "arrays.npz: member 'a.npy'", "dtype <f4", "'<f2'");
  refuses("'>f4'", "(1,)", "'>f4'");
  refuses("'|O'", "(1,)", "'|O'");
  refuses_npz(deflated(npy_file("'<f4'", "(1,)", kFourBytes, "True")), "C order", "Fortran");
  refuses("'<f4'", "(2,)", "shape (2,)", "found 4 bytes");
  refuses("'<f4'", "(0,)", "shape (0,)", "found 4 bytes");
  refuses("'|u1'", "()", "shape ()", "found 4 bytes");
  refuses("'<f4'", "(-1,)", "a size in 'shape'");
  refuses("'<f4'", "(99999999999999999999,)", "below 2^63");
  refuses("'<f4'", "(4294967296, 4294967296)", "(4294967296, 4294967296)");
  // 2^62 + 1 floats are 4 bytes modulo 2^64.
  refuses("'<f4'", "(4611686018427387905,)", "(4611686018427387905,)");
}

TEST_CASE("damaged contents are refused by their checksum") {
  const std::string array = npy_file("'|u1'", "(4,)", kFourBytes);
  for (HandMember member : {stored(array), deflated(array)}) {
    member.packed.back() = '\x7F';
    refuses_npz(member, "'a.npy'", "right checksum", "CRC");
  }
  HandMember broken = deflated(array);
  broken.packed[0] = '\x07';  // deflate has no block of kind 3
  refuses_npz(broken, "'a.npy'", "can be unpacked");
}

TEST_CASE("a claimed size is not believed") {
  // The claim and the header agree, the packed bytes hold less: nothing of the kind is allocated.
  const auto refuses = [](HandMember member, std::uint64_t claimed, const auto&... parts) {
    member.claimed_bytes += claimed - kFourBytes.size();
    refuses_npz(member, "'a.npy'", parts...);
  };
  const std::string huge = npy_file("'|u1'", "(4000000000,)", kFourBytes);
  refuses(stored(huge), 4000000000, "1 bytes from each", "a claim of 4000");
  refuses(deflated(huge), 4000000000, "1032 bytes from each");
  // What deflate could have done, but has not.
  refuses(deflated(npy_file("'|u1'", "(50000,)", kFourBytes)), 50000, "expected 50");
  // More is packed than is claimed.
  refuses(deflated(npy_file("'|u1'", "(0,)", kFourBytes)), 0, "expected");
}

TEST_CASE("arrays above the limit are refused before they are unpacked") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("arrays.npz");
  const std::int64_t bytes = 4 << 20;
  NpzArrays arrays;
  arrays["first"] = npz_array(std::vector<float>(bytes / 4), {bytes / 4});
  arrays["second"] = arrays["first"];
  write_npz(path, arrays);
  CHECK(file_contents(path).size() < 20000);
  CHECK(read_npz(path, 2 * bytes).size() == 2);
  CHECK(refused_with([&] { read_npz(path, 2 * bytes - 1); }, path, "second", "too large",
                     "at most 4194303 bytes", "found 4194304"));
  CHECK(refused_with([&] { read_npz(path, 1000); }, "first", "too large"));
  std::filesystem::resize_file(path, 80 << 20);  // takes no space on the disk
  CHECK(refused_with([&] { read_npz(path, 1000); }, path, "too large"));
}

TEST_CASE("members that share their packed bytes are refused") {
  std::string file = zip_of({stored(npy_file("'|u1'", "(4,)", kFourBytes)),
                             stored(npy_file("'|u1'", "(4,)", kFourBytes), "b.npy")});
  // Both directory entries claim more than half of the file.
  for (std::size_t at = file.find("PK\x01\x02"); at != std::string::npos;
       at = file.find("PK\x01\x02", at + 1)) {
    file.replace(at + 20, 4, little_endian(file.size() - 100, 4));
  }
  refuses_npz(file, "'b.npy'", "packed bytes in the rest of the file");
}

TEST_CASE("arrays that numpy could not read, and places that cannot be written, are refused") {
  const TemporaryDirectory directory;
  const auto refuses = [&](const std::string& name, const NpzArray& array, const auto&... parts) {
    CHECK(refused_with([&] { write_npz(directory.file("out.npz"), {{name, array}}); }, parts...));
  };
  const NpzArray good = npz_array(std::vector<float>{1}, {1});
  refuses("", good, "out.npz", "1 to 65531 bytes");
  refuses(std::string("a\0b", 3), good, "zero byte");
  refuses("\xFF\xFE", good, "UTF-8");
  refuses(std::string(65532, 'n'), good, "nnn...", "of 65532 bytes");
  refuses("a", {"<f2", {1}, {}}, "array 'a'", "dtype", "'<f2'");
  refuses("a", {"<f4", {2}, std::vector<std::byte>(4)}, "array 'a'", "(2,)", "found 4 bytes");
  refuses("a", {"<f4", {-1}, {}}, "array 'a'", "(-1,)");
  refuses("a", {"|u1", std::vector<std::int64_t>(33, 1), {std::byte{1}}}, "array 'a'");
  CHECK(refused_with([&] { write_npz(directory.file("out.npz"), {}); }, "at least one array"));
  CHECK(std::filesystem::is_empty(directory.path()));
  CHECK(refused_with([&] { write_npz(directory.file("none/arrays.npz"), some_arrays()); },
                     "cannot be written", "folder exists"));
  CHECK(refused_with([&] { write_npz(directory.path(), some_arrays()); }, "cannot be written"));
}
