#include "hqslam/core/npy.h"

#include "testing.h"
#include "zip_by_hand.h"

namespace {

constexpr const char* kTwoImages = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1, 3), }";
NpyStackReader read_stack(const std::string& path) { return NpyStackReader(path); }

}  // namespace

TEST_CASE("an .npy stack written by hand is read image by image in any order") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("scans.npy");
  for (const char version : {'\1', '\2', '\3'}) {
    write_file(path, npy_of(kTwoImages, raw_bytes({1, 2, 3, 4, 5, 6}), version));
    NpyStackReader reader(path);
    REQUIRE(reader.images() == 2);
    CHECK(reader.rows() == 1);
    CHECK(reader.columns() == 3);
    CHECK(reader.read(1).range_m == std::vector<float>{4, 5, 6});
    CHECK(reader.read(0).range_m == std::vector<float>{1, 2, 3});
    CHECK(refused_with([&] { reader.read(2); }, path, "0 to 1", "found 2"));
  }
  // What an interrupted append leaves behind the last image is not read.
  write_file(path, npy_of(kTwoImages, raw_bytes({1, 2, 3, 4, 5, 6}) + "half an im"));
  CHECK(NpyStackReader(path).images() == 2);
}

TEST_CASE("a trailing axis of one and other spellings of the header mean the same") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("scans.npy");
  write_file(path, npy_of("{\"shape\":(1,2,2,1),\"descr\":\"<f4\",\"fortran_order\":False}   ",
                          raw_bytes({1, 2, 3, 4})));
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
  CHECK(contents.ends_with(raw_bytes(1.5)));
  CHECK(refused_with([&] { writer.append(std::vector<double>(13)); }, path, "14", "13"));
}

TEST_CASE("a file that is no stack of range images is refused in one line that says why") {
  const std::string data = raw_bytes({1, 2, 3, 4, 5, 6});
  const auto refuses = [](const std::string& contents, const auto&... parts) {
    CAPTURE(contents);
    CHECK(refused_with([&] { from_file("scans.npy", contents, read_stack); }, parts...));
  };
  refuses("x y z\n1 2 3\n", "scans.npy", "NUMPY");
  refuses("", "scans.npy", "NUMPY");
  refuses(npy_of(kTwoImages, data, 9), "9.0");
  refuses(npy_of(kTwoImages, data).substr(0, 40), "truncated");
  refuses(npy_of(kTwoImages, data.substr(0, 23)), "truncated", "2 images of 12 bytes", "found 23");
  refuses(npy_of(kTwoImages, data + data), "too long");
  refuses(npy_file("'<f8'", "(1, 1, 3)", data), "'<f4'", "'<f8'", "astype");
  refuses(npy_file("'<f4'", "(2, 1, 3)", data, "True"), "Fortran");
  refuses(npy_file("'<f4'", "(2, 3)", data), "(N, rows, columns)", "(2, 3)");
  refuses(npy_file("'<f4'", "(2, 0, 3)", data), "(2, 0, 3)");
  refuses(npy_file("[('x', '<f4')]", "(6,)", data), "structures");
  // No dictionary of the three keys.
  for (const char* dictionary :
       {"", "{", "{}", "{'descr': '<f4'", "{'descr': '<f4', 'fortran_order': False}",
        "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1)}",
        "{'descr': '<f4', 'fortran_order': 1, 'shape': (1, 1, 1)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1)} more",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1), 'x': 1}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': [1, 1, 1]}", "{'descr"}) {
    refuses(npy_of(dictionary, data), "scans.npy", "damaged .npy header", "expected");
  }
}

TEST_CASE("sizes that overflow or exceed the file are refused before anything is allocated") {
  for (const auto& [shape, said] : {std::pair("(4611686018427387904, 1, 4)", "truncated"),
                                    {"(99999999999999999999, 1, 3)", "below 2^63"},
                                    {"(1, 4294967296, 4294967296)", "4294967296"},
                                    {"(-1, 1, 3)", "size"},
                                    {"(1, 65536, 65536)", "truncated"}}) {
    CAPTURE(shape);
    const std::string contents = npy_file("'<f4'", shape, raw_bytes({1, 2, 3}));
    CHECK(refused_with([&] { from_file("scans.npy", contents, read_stack); }, said));
  }
}
