// Archives of layer images: what goes in comes out, for every format; whole or not at all; held against a slicer's own.
#include "print/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include "archive_fixtures.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/zip_file.h"

namespace gonio::print {
namespace {

using tests::full_job;
using tests::Layer;
using tests::some_layers;
using tests::write_layers;

std::filesystem::path named(const tests::ScratchFolder& folder, const ArchiveFormat& format,
                            const std::string& stem = "job") {
  return folder / (stem + format.extensions[0]);
}

Layer layer_of(ArchiveReader& reader, std::size_t k) {
  Layer layer(static_cast<std::size_t>(reader.job().width_px) * reader.job().height_px);
  reader.read(k, layer);
  return layer;
}

void expect_near(const std::optional<double>& found, const std::optional<double>& stated, double relative) {
  ASSERT_EQ(found.has_value(), stated.has_value());
  if (found) {
    EXPECT_NEAR(*found, *stated, relative * std::abs(*stated));
  }
}

// What a format says that it holds is there again, to single precision; the rest is not.
void expect_job(const Job& found, const Job& stated, unsigned holds) {
  EXPECT_EQ(found.width_px, stated.width_px);
  EXPECT_EQ(found.height_px, stated.height_px);
  const auto if_held = [&](JobPart part, auto Job::*member) {
    if ((holds & part) == 0) {
      EXPECT_EQ(found.*member, Job{}.*member);
    } else if constexpr (std::is_same_v<decltype(member), std::optional<double> Job::*>) {
      expect_near(found.*member, stated.*member, 1e-6);
    } else {
      EXPECT_EQ(found.*member, stated.*member);
    }
  };
  ASSERT_EQ(found.pixel_m.has_value(), (holds & job_pixel_size) != 0);
  if (found.pixel_m) {
    EXPECT_NEAR(found.pixel_m->x, stated.pixel_m->x, 1e-6 * stated.pixel_m->x);
    EXPECT_NEAR(found.pixel_m->y, stated.pixel_m->y, 1e-6 * stated.pixel_m->y);
  }
  if_held(job_layers, &Job::layer_m);
  if_held(job_mirror, &Job::mirror_x), if_held(job_mirror, &Job::mirror_y);
  if_held(job_exposure, &Job::exposure_s), if_held(job_exposure, &Job::bottom_exposure_s);
  if_held(job_exposure, &Job::bottom_layers);
  if_held(job_lift, &Job::lift_m), if_held(job_lift, &Job::lift_m_per_s), if_held(job_lift, &Job::retract_m_per_s);
  if_held(job_name, &Job::name), if_held(job_printer, &Job::printer), if_held(job_resin_name, &Job::resin);
  if_held(job_resin_density, &Job::resin_kg_per_m3), if_held(job_resin_volume, &Job::resin_m3);
  if_held(job_time, &Job::printing_s);
  EXPECT_EQ(found.previews.size(), (holds & job_previews) != 0 ? stated.previews.size() : 0);
}

TEST(Archives, WhatGoesInComesOutOfEveryFormat) {
  const tests::ScratchFolder folder;
  for (const ArchiveFormat* format : all_archive_formats())
    for (const auto [width, height, count] : {std::array{37, 21, 5}, std::array{1, 1, 1}, std::array{64, 3, 12}}) {
      SCOPED_TRACE(std::string(format->name) + " " + std::to_string(width));
      const auto path = named(folder, *format, "job" + std::to_string(width));
      const auto layers = some_layers(width, height, count, 7 + width);
      const Job job = full_job(width, height);
      write_layers(*format, path, job, layers);
      const auto reader = open_archive(path);
      expect_job(reader->job(), job, format->holds);
      ASSERT_EQ(reader->layers(), layers.size());
      const int step = 256 / format->greys;
      for (std::size_t i = layers.size(); i-- > 0;) {  // backwards, too
        const Layer found = layer_of(*reader, i);
        for (std::size_t p = 0; p < found.size(); ++p)
          ASSERT_LT(std::abs(int{found[p]} - int{layers[i][p]}), step) << "layer " << i << ", pixel " << p;
      }
      if ((format->holds & (job_layers | job_each_layer)) != 0) {
        ASSERT_EQ(reader->job().tops_m.size(), layers.size());
        for (std::size_t k = 0; k < layers.size(); ++k) EXPECT_NEAR(reader->job().tops_m[k], 25e-6 * (k + 1), 1e-9);
      }
      std::vector<std::string> lost = left_out(*format, job);
      for (const std::string& words : lost) EXPECT_FALSE(words.empty());
      EXPECT_EQ(lost.size(), 12u - static_cast<std::size_t>(std::popcount(format->holds & ~job_each_layer)));
    }
}

TEST(Archives, BlackAndWhiteAreExactInEveryFormat) {
  const tests::ScratchFolder folder;
  for (const ArchiveFormat* format : all_archive_formats()) {
    Layer checks(40 * 30);
    for (std::size_t i = 0; i < checks.size(); ++i) checks[i] = i * i % 7 < 3 ? 255 : 0;
    const auto path = named(folder, *format);
    write_layers(*format, path, full_job(40, 30), {checks, Layer(40 * 30, 255), Layer(40 * 30, 0)});
    const auto reader = open_archive(path);
    EXPECT_EQ(layer_of(*reader, 0), checks) << format->name;
    EXPECT_EQ(layer_of(*reader, 1), Layer(40 * 30, 255)) << format->name;
    EXPECT_EQ(layer_of(*reader, 2), Layer(40 * 30, 0)) << format->name;
  }
}

std::string all_bytes(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return read_file(path);
  std::vector<std::filesystem::path> files(std::filesystem::directory_iterator(path), {});
  std::sort(files.begin(), files.end());
  std::string bytes;
  for (const auto& file : files) bytes += file.filename().string() + read_file(file);
  return bytes;
}

TEST(Archives, TheSameInputGivesTheSameBytesAndReplacesWhatWasThere) {
  const tests::ScratchFolder folder;
  const auto layers = some_layers(33, 20, 4, 3);
  for (const ArchiveFormat* format : all_archive_formats()) {
    const auto path = named(folder, *format);
    write_layers(*format, path, full_job(33, 20), some_layers(33, 20, 6, 4));
    write_layers(*format, path, full_job(33, 20), layers);
    const std::string first = all_bytes(path);
    write_layers(*format, path, full_job(33, 20), layers);
    EXPECT_EQ(all_bytes(path), first) << format->name;
    // Encoded by the caller, what is read back written again: the same once more.
    const auto writer = format->begin(path, full_job(33, 20));
    for (std::size_t k = 0; k < layers.size(); ++k)
      writer->add_encoded(format->encode(full_job(33, 20), layers[k]), 25e-6 * k, 25e-6 * (k + 1));
    writer->finish();
    EXPECT_EQ(all_bytes(path), first) << format->name;
  }
}

TEST(Archives, NothingIsLeftWithoutAnEnd) {
  for (const ArchiveFormat* format : all_archive_formats()) {
    const tests::ScratchFolder folder;
    const auto path = named(folder, *format);
    {
      const auto writer = format->begin(path, full_job(8, 8));
      writer->add(Layer(64, 9), 0, 25e-6);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << format->name;
    const pid_t child = ::fork();
    if (child == 0) {  // interrupted midway: the next layer is refused, and what was begun goes
      install_signal_handlers();
      int status = 1;
      try {
        const auto writer = format->begin(path, full_job(8, 8));
        writer->add(Layer(64, 9), 0, 25e-6);
        ::raise(SIGTERM);
        for (int k = 1; k < 4; ++k) writer->add(Layer(64, 9), 25e-6 * k, 25e-6 * (k + 1));
        writer->finish();
      } catch (const Error& error) {
        status = static_cast<int>(error.code());
      }
      ::_exit(status);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(Exit::try_again)) << format->name;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << format->name;
  }
}

TEST(Archives, KilledMidwayTheyLeaveNoFile) {
  const tests::ScratchFolder folder;
  const auto path = folder / "job.sl1";
  write_layers(archive_format(path), path, full_job(8, 8), {Layer(64, 9)});
  const std::string before = read_file(path);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto writer = archive_format(path).begin(path, full_job(8, 8));
    writer->add(Layer(64, 7), 0, 25e-6);
    ::raise(SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(read_file(path), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Archives, AFolderWithAnythingElseInItIsNotReplaced) {
  const tests::ScratchFolder folder;
  std::ofstream(folder / "thesis.tex") << "years of work";
  const ArchiveFormat& stack = archive_format(folder.path() / "");
  try {
    stack.begin(folder.path(), full_job(8, 8));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::cannot_create);
    EXPECT_THAT(error.what(), testing::HasSubstr("thesis.tex"));
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "thesis.tex"));
}

TEST(Archives, MemoryDoesNotGrowWithTheLayers) {
  const tests::ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    const auto high_water_kb = [] {
      std::ifstream status("/proc/self/status");
      for (std::string word; status >> word;)
        if (word == "VmHWM:") {
          long kb = 0;
          status >> kb;
          return kb;
        }
      return 0L;
    };
    const Job job = full_job(2560, 1600);
    const ArchiveFormat& format = archive_format("big.sl1");
    const std::string encoded = format.encode(job, some_layers(2560, 1600, 1, 5)[0]);
    const auto writer = format.begin(folder / "big.sl1", job);
    writer->add_encoded(encoded, 0, 25e-6);
    const long before = high_water_kb();
    const std::string small = encoded.substr(0, 20000);  // nobody looks at it
    for (int k = 1; k < 5000; ++k) writer->add_encoded(small, 25e-6 * k, 25e-6 * (k + 1));
    const long grown = high_water_kb() - before;
    writer->finish();  // which draws previews by a library that is loaded then
    ::_exit(grown < 8192 ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_GT(std::filesystem::file_size(folder / "big.sl1"), 5000u * 20000u);
}

TEST(Archives, ASlicersOwnIsReadAndWrittenBack) {
  GONIO_NEEDS_DATA("print/uvtools_demo");
  const auto original = tests::data("print/uvtools_demo") / "UVtools_demo_file.sl1s";
  const auto reader = open_archive(original);
  const Job& job = reader->job();
  EXPECT_EQ(job.width_px, 1620);
  EXPECT_EQ(job.height_px, 2560);
  ASSERT_TRUE(job.pixel_m && job.layer_m && job.exposure_s && job.bottom_exposure_s);
  EXPECT_NEAR(job.pixel_m->x, 50e-6, 1e-12);
  EXPECT_NEAR(job.pixel_m->y, 50e-6, 1e-12);
  EXPECT_NEAR(*job.layer_m, 1e-4, 1e-12);
  EXPECT_EQ(job.exposure_s, 3);
  EXPECT_EQ(job.bottom_exposure_s, 20);
  EXPECT_EQ(job.bottom_layers, 10);
  EXPECT_EQ(job.mirror_x, true);
  EXPECT_EQ(job.printer, "SL1S");
  EXPECT_NEAR(*job.printing_s, 186.727273, 1e-9);
  EXPECT_NEAR(*job.resin_m3, 1.287402e-6, 1e-15);
  ASSERT_EQ(job.previews.size(), 2u);
  ASSERT_EQ(reader->layers(), 10u);
  const tests::ScratchFolder folder;
  const ArchiveFormat& format = archive_format("again.sl1s");
  const auto writer = format.begin(folder / "again.sl1s", job);
  std::vector<double> area_mm2;
  for (std::size_t k = 0; k < reader->layers(); ++k) {
    const Layer layer = layer_of(*reader, k);
    area_mm2.push_back(std::accumulate(layer.begin(), layer.end(), 0.0) / 255 * 0.05 * 0.05);
    writer->add(layer, k == 0 ? 0 : job.tops_m[k - 1], job.tops_m[k]);
  }
  writer->finish();
  // Areas that others counted in these pictures (SOURCE.md beside the data).
  EXPECT_NEAR(area_mm2[0], 1186.257, 5e-4);
  EXPECT_NEAR(area_mm2[3], 1252.487, 5e-4);
  EXPECT_NEAR(area_mm2[9], 1390.826, 5e-4);
  const auto again = open_archive(folder / "again.sl1s");
  for (std::size_t k = 0; k < reader->layers(); ++k) EXPECT_EQ(layer_of(*again, k), layer_of(*reader, k)) << k;
  EXPECT_EQ(again->job().further, job.further);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(again->job().previews[i].rgb, job.previews[i].rgb);
  const io::ZipReader a(original), b(folder / "again.sl1s");
  for (const char* file : {"config.ini", "prusaslicer.ini"})
    EXPECT_EQ(a.read(a.find(file), 1 << 20), b.read(b.find(file), 1 << 20)) << file;
}

TEST(Archives, AFormatIsFoundByItsNameOrItsEnding) {
  EXPECT_STREQ(archive_format("a/b.SL1S").name, "SL1");
  EXPECT_STREQ(archive_format("a/b.zip").name, "zip");
  EXPECT_STREQ(archive_format("folder/").name, "PNG");
  EXPECT_STREQ(archive_format("x.out", "sl1").name, "SL1");
  for (const char* name : {"x.stl", "x.sl2"}) {
    try {
      archive_format(name);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::usage);
      EXPECT_THAT(error.what(), testing::HasSubstr(".sl1s"));
    }
  }
}

}  // namespace
}  // namespace gonio::print
