// Archives of layer images that are broken, or lie: one line that names file, place, value and remedy, and the right
// exit status, whatever the format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "archive_fixtures.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/little_endian.h"
#include "io/zip_file.h"
#include "print/archive.h"

namespace gonio::print {
namespace {

using namespace tests;
using Files = std::vector<std::pair<std::string, std::string>>;

// Opens it and reads all layers; what() of the refusal.
std::string refusal(const std::filesystem::path& path, Exit code = Exit::data) {
  try {
    const auto reader = open_archive(path);
    Layer layer(static_cast<std::size_t>(reader->job().width_px) * reader->job().height_px);
    for (std::size_t k = 0; k < reader->layers(); ++k) reader->read(k, layer);
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(error.code(), code) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_THAT(what, testing::StartsWith(path.string()));
    EXPECT_FALSE(error.remedy().empty()) << what;
    EXPECT_LT(what.size(), 400u);
    return what;
  }
  return "was read";
}

std::string png(int width, int height) {
  return archive_format("a.sl1").encode(print::Job{.width_px = width, .height_px = height},
                                        some_layers(width, height, 1, 9)[0]);
}

Files sound_sl1() {
  return {{"config.ini", "jobDir = j\nlayerHeight = 0.05\nexpTime = 2\nexpTimeFirst = 9\nnumFade = 3\nnumFast = 2\n"},
          {"prusaslicer.ini",
           "display_pixels_x = 16\ndisplay_pixels_y = 8\ndisplay_width = 1.6\ndisplay_height = 0.8\n"
           "display_mirror_x = 1\n"},
          {"j00000.png", png(16, 8)},
          {"j00001.png", png(16, 8)}};
}
std::string& file(Files& files, const std::string& name) {
  for (auto& [own, bytes] : files)
    if (own == name) return bytes;
  throw std::out_of_range(name);
}
void replace(std::string& text, const std::string& what, const std::string& by) {
  text.replace(text.find(what), what.size(), by);
}
void write_zip(const std::filesystem::path& path, const Files& files) {
  io::ZipWriter zip(path);
  for (const auto& [name, bytes] : files) zip.add(name, bytes);
  zip.commit();
}

struct Sl1Fault {
  const char* says;  // part of the refusal
  std::function<void(Files&)> harm;
};

TEST(BadArchives, Sl1) {
  const auto config = [](const char* what, const char* by) {
    return [=](Files& f) { replace(file(f, "config.ini"), what, by); };
  };
  const auto slicer = [](const char* what, const char* by) {
    return [=](Files& f) { replace(file(f, "prusaslicer.ini"), what, by); };
  };
  const std::vector<Sl1Fault> faults{
      {"has no config.ini", [](Files& f) { f.erase(f.begin()); }},
      {"states \"nan\" as layerHeight", config("0.05", "nan")},
      {"states \"inf\" as expTime", config("expTime = 2", "expTime = inf")},
      {"states \"2 s\" as expTime", config("expTime = 2", "expTime = 2 s")},
      {"states -3 as the exposure", config("expTime = 2", "expTime = -3")},
      {"states 0 as the thickness", config("0.05", "0")},
      {"states no layerHeight", config("layerHeight", "layerheight")},
      {"states \"2.5\" as numFade", config("numFade = 3", "numFade = 2.5")},
      {"counts 7 layers in numFast and numSlow, and there are 2", config("numFast = 2", "numFast = 7")},
      {"as jobDir", config("jobDir = j", "jobDir = ../../j")},
      {"has \"garbage\" in line 2", config("layerHeight = 0.05", "garbage")},
      {"states a display of -16 x 8", slicer("display_pixels_x = 16", "display_pixels_x = -16")},
      {"pictures of 1000000 x 8", slicer("display_pixels_x = 16", "display_pixels_x = 1000000")},
      {"display that the archive states 17 x 8", slicer("display_pixels_x = 16", "display_pixels_x = 17")},
      {"states \"wide\" as display_width", slicer("= 1.6", "= wide")},
      {"no picture of a layer", [](Files& f) { f.resize(2); }},
      {"no picture with the number 1, and one with 2", [](Files& f) { f[3].first = "j00002.png"; }},
      {"no picture with the number 1, and one with 5",
       [](Files& f) { f[2].first = "j00005.png", f[3].first = "j00006.png"; }},
      {"has two pictures with the number 0", [](Files& f) { f[3].first = "k00000.png"; }},
      {"has 8 x 8 pixels, and other layers 16 x 8", [](Files& f) { f[3].second = png(8, 8); }},
      {"is no PNG picture", [](Files& f) { f[2].second = "JFIF, or so, of more than thirty-three bytes"; }},
      {"j00001.png", [](Files& f) { f[3].second.resize(f[3].second.size() / 2); }},
      {"j00001.png", [](Files& f) { f[3].second[60] ^= 1; }},
      {"is no PNG picture", [](Files& f) { f[2].second.clear(); }},
      {"leaves the archive",
       [](Files& f) {
         f.push_back({"../../home/x.png", "x"});
       }},
      {"two entries \"config.ini\"", [](Files& f) { f.push_back(f[0]); }},
      {"thumbnail",
       [](Files& f) {
         f.push_back({"thumbnail/thumbnail9x9.png", "no picture, but long enough for one"});
       }},
      {"more than 1048576", [](Files& f) { f[0].second.append(2000000, ' '); }}};
  const tests::ScratchFolder folder;
  write_zip(folder / "sound.sl1", sound_sl1());
  EXPECT_EQ(refusal(folder / "sound.sl1"), "was read");
  for (const Sl1Fault& fault : faults) {
    Files files = sound_sl1();
    fault.harm(files);
    write_zip(folder / "bad.sl1", files);
    EXPECT_THAT(refusal(folder / "bad.sl1"), testing::HasSubstr(fault.says));
  }
}

TEST(BadArchives, FilesThatEndEarlyOrAreNone) {
  const tests::ScratchFolder folder;
  EXPECT_THAT(refusal(folder / "missing.sl1", Exit::no_input), testing::HasSubstr("is not there"));
  std::ofstream(folder / "empty.sl1").close();
  EXPECT_THAT(refusal(folder / "empty.sl1"), testing::HasSubstr("is no archive of layer images"));
  std::ofstream(folder / "text.sl1") << "no zip at all";
  EXPECT_THAT(refusal(folder / "text.sl1"), testing::HasSubstr("is no whole zip archive"));
  std::filesystem::create_directory(folder / "stack");
  EXPECT_THAT(refusal(folder / "stack"), testing::HasSubstr("no picture of a layer"));
  std::ofstream(folder / "stack" / "0.png") << "a";
  EXPECT_THAT(refusal(folder / "stack"), testing::HasSubstr("stack"));
  std::filesystem::create_directories(folder / "holes");
  for (const char* name : {"0.png", "1.png", "3.png"}) write_file(folder / "holes" / name, png(4, 4));
  EXPECT_THAT(refusal(folder / "holes"), testing::HasSubstr("no picture with the number 2, and one with 3"));
  // Whatever is cut off at whatever place, and in whatever format, is one line.
  for (const ArchiveFormat* format : all_archive_formats()) {
    if (format->extensions[0].empty()) continue;
    const auto path = folder / ("whole" + format->extensions[0]);
    write_layers(*format, path, full_job(16, 8), some_layers(16, 8, 3, 2));
    const std::string whole = read_file(path);
    for (std::size_t length = 1; length < whole.size(); length += 1 + whole.size() / 50) {
      write_file(path, whole.substr(0, length));
      EXPECT_NE(refusal(path), "was read") << format->name << " cut to " << length;
    }
  }
}

// An entry of a million zeros for every byte it has, and one that claims 4 GB.
TEST(BadArchives, ZipsThatSwell) {
  const tests::ScratchFolder folder;
  const std::string script =
      "import zipfile, sys\n"
      "z = zipfile.ZipFile(sys.argv[1], \"w\", zipfile.ZIP_DEFLATED)\n"
      "z.writestr(\"config.ini\", \"jobDir = j\\nlayerHeight = 0.05\\n\")\n"
      "z.writestr(\"j00000.png\", "
      "b\"\\x89PNG\\r\\n\\x1a\\n\\0\\0\\0\\rIHDR\\0\\0\\0\\x10\\0\\0\\0\\x08\\x08\\0\\0\\0\\0\" + bytes(40000000))\n"
      "z.close()\n";
  ASSERT_EQ(std::system(("python3 -c '" + script + "' " + (folder / "bomb.sl1").string()).c_str()), 0);
  EXPECT_LT(std::filesystem::file_size(folder / "bomb.sl1"), 100000u);
  EXPECT_THAT(refusal(folder / "bomb.sl1"), testing::HasSubstr("has 40000029 bytes, more than"));
  write_zip(folder / "claims.zip", {{"0.png", png(16, 8)}});
  std::string bytes = read_file(folder / "claims.zip");
  const std::size_t directory = bytes.find("PK\x01\x02");
  io::store_at(bytes, directory + 24, std::uint32_t{0xfffffff0});
  io::store_at(bytes, 22, std::uint32_t{0xfffffff0});
  write_file(folder / "claims.zip", bytes);
  EXPECT_THAT(refusal(folder / "claims.zip"), testing::HasSubstr("claims 4294967280 bytes"));
}

TEST(BadArchives, ManifestsOfPlainZips) {
  const tests::ScratchFolder folder;
  const auto with = [&](const std::string& manifest) {
    write_zip(folder / "a.zip", {{"1.png", png(16, 8)}, {"2.png", png(16, 8)}, {"manifest.uvtools", manifest}});
    return refusal(folder / "a.zip");
  };
  EXPECT_EQ(with("<Manifest><LayerHeight>0.05</LayerHeight></Manifest>"), "was read");
  EXPECT_THAT(with("<LayerHeight>NaN</LayerHeight>"), testing::HasSubstr("states \"NaN\" as LayerHeight"));
  EXPECT_THAT(with("<LayerHeight>0.05"), testing::HasSubstr("does not close its LayerHeight"));
  EXPECT_THAT(with("<ResolutionX>1e9</ResolutionX><ResolutionY>2</ResolutionY>"), testing::HasSubstr("x 2 pixels"));
  EXPECT_THAT(with("<ResolutionX>8</ResolutionX><ResolutionY>16</ResolutionY>"), testing::HasSubstr("states 8 x 16"));
}

struct CtbFault {
  const char* says;
  std::size_t offset;
  std::uint32_t value;
};
TEST(BadArchives, Ctb) {
  const tests::ScratchFolder folder;
  const auto path = folder / "a.ctb";
  write_layers(archive_format(path), path, full_job(16, 8), some_layers(16, 8, 3, 2));
  const std::string sound = read_file(path);
  const std::uint32_t nan = 0x7fc00000, table = io::stored_at<std::uint32_t>(sound, 0x40),
                      preview = io::stored_at<std::uint32_t>(sound, 0x3c);
  for (const CtbFault& fault : {CtbFault{"is locked by its maker", 0, 0x12fd0107},
                                {"states no number as its layer height", 0x20, nan},
                                {"states no number as its exposure", 0x24, 0x7f800000},
                                {"states no number as its layer's height", table, nan},
                                {"pictures of 0 x 8", 0x34, 0},
                                {"pictures of 4000000000 x 8", 0x34, 4000000000u},
                                {"ends after 128 of", 0x34, 17},
                                {"goes on behind its last pixel", 0x34, 15},
                                {"counts 0 layers", 0x44, 0},
                                {"counts 4000000000 layers", 0x44, 4000000000u},
                                {"layer table has", 0x44, 900000},
                                {"layer table has 108 bytes from 4294967295 on", 0x40, 0xffffffff},
                                {"layer 1 has", table + 36 + 16, 0xffffff},
                                {"layer 2 has", table + 2 * 36 + 12, 0xfffffff0},
                                {"settings has", 0x54, 0x7fffffff},
                                {"preview has", 0x3c, 0x7fffffff},
                                {"pixels", preview, 100000},
                                {"bottom layers", 0x30, 0x7fffffff}}) {
    std::string bytes = sound;
    io::store_at(bytes, fault.offset, fault.value);
    write_file(path, bytes);
    EXPECT_THAT(refusal(path), testing::HasSubstr(fault.says)) << fault.offset;
  }
  std::string runs = sound;
  const auto first = io::stored_at<std::uint32_t>(sound, table + 12),
             size = io::stored_at<std::uint32_t>(sound, table + 16);
  for (std::uint32_t i = 0; i < size; ++i) runs[first + i] = '\xff';
  write_file(path, runs);
  EXPECT_THAT(refusal(path), testing::HasSubstr("layer 0: has a run of no known length"));
}

TEST(BadArchives, LevelSets) {
  const tests::ScratchFolder folder;
  const auto path = folder / "a.cbddlp";
  write_layers(archive_format(path), path, full_job(16, 8), some_layers(16, 8, 3, 2));
  const std::string sound = read_file(path);
  for (const std::uint32_t sets : {0u, 65u, 9u}) {
    std::string bytes = sound;
    io::store_at(bytes, 0x5c, sets);
    write_file(path, bytes);
    EXPECT_NE(refusal(path), "was read") << sets;
  }
}

// What a job says that cannot be, and layers that do not follow each other.
TEST(BadArchives, Jobs) {
  const tests::ScratchFolder folder;
  const auto path = folder / "a.sl1";
  const ArchiveFormat& format = archive_format(path);
  const auto refused = [&](const std::function<void()>& action) -> std::string {
    try {
      action();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_FALSE(std::filesystem::exists(path));
      return error.what();
    }
    return "was taken";
  };
  const auto begun = [&](const std::function<void(Job&)>& harm) {
    return refused([&] {
      Job job = full_job(16, 8);
      harm(job);
      format.begin(path, job);
    });
  };
  EXPECT_THAT(begun([](Job& j) { j.width_px = 0; }), testing::HasSubstr("0 x 8 pixels"));
  EXPECT_THAT(begun([](Job& j) { j.exposure_s = std::nan(""); }), testing::HasSubstr("states nan as the exposure"));
  EXPECT_THAT(begun([](Job& j) { j.exposure_s.reset(); }), testing::HasSubstr("no exposure"));
  EXPECT_THAT(begun([](Job& j) { j.pixel_m.reset(); }), testing::HasSubstr("no size of pixels"));
  EXPECT_THAT(begun([](Job& j) { j.pixel_m->y = -1; }), testing::HasSubstr("height of a pixel"));
  EXPECT_THAT(begun([](Job& j) { j.previews.push_back(j.previews[0]); }),
              testing::HasSubstr("two previews of one size"));
  EXPECT_THAT(begun([](Job& j) { j.previews[0].rgb.pop_back(); }), testing::HasSubstr("#preview"));
  EXPECT_THAT(begun([](Job& j) { j.resin = "a\nb = c"; }), testing::HasSubstr("two lines"));
  const auto layered = [&](std::vector<std::array<double, 2>> heights, std::size_t pixels = 128) {
    return refused([&] {
      const auto writer = format.begin(path, full_job(16, 8));
      for (const auto& [bottom, top] : heights) writer->add(Layer(pixels), bottom, top);
      writer->finish();
    });
  };
  EXPECT_THAT(layered({}), testing::HasSubstr("has no layer"));
  EXPECT_THAT(layered({{0, 25e-6}}, 127), testing::HasSubstr("has 127 pixels, and the job 16 x 8"));
  EXPECT_THAT(layered({{1e-5, 25e-6}}), testing::HasSubstr("layer 0: begins at 1e-05 m"));
  EXPECT_THAT(layered({{0, 25e-6}, {30e-6, 55e-6}}), testing::HasSubstr("layer 1: begins at"));
  EXPECT_THAT(layered({{0, 25e-6}, {25e-6, 25e-6}}), testing::HasSubstr("thickness above 0"));
  EXPECT_THAT(layered({{0, std::nan("")}}), testing::HasSubstr("layer 0"));
  EXPECT_THAT(layered({{0, 25e-6}, {25e-6, 55e-6}}), testing::HasSubstr("SL1 has one thickness"));
  EXPECT_EQ(layered({{0, 40e-6}, {40e-6, 65e-6}}), "was taken");  // the lowest may be another
  EXPECT_NEAR(open_archive(path)->job().tops_m[1], 65e-6, 1e-12);
}

}  // namespace
}  // namespace gonio::print
