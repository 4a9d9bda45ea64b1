// Zip files entry by entry, held against Python's zipfile, which knows zip64.
#include "io/zip_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "base/error.h"
#include "data.h"

namespace gonio::io {
namespace {

// Python's own verdict: names and contents are "name" -> name repeated.
int python_says(const std::filesystem::path& file, std::size_t entries) {
  const std::string script =
      "import sys, zipfile\n"
      "z = zipfile.ZipFile(sys.argv[1])\n"
      "names = z.namelist()\n"
      "assert len(names) == int(sys.argv[2]), len(names)\n"
      "assert z.testzip() is None\n"
      "assert all(i.date_time == (1980, 1, 1, 0, 0, 0) and i.compress_type == 0 for i in z.infolist())\n"
      "for name in names[:3] + names[-3:]: assert z.read(name) == 3 * name.encode(), name\n";
  return std::system(("python3 -c '" + script + "' " + file.string() + " " + std::to_string(entries)).c_str());
}

std::string name_of(std::size_t i) {
  return "folder/entry" + std::to_string(i) + ".png";
}

void write_entries(const std::filesystem::path& path, std::size_t count, std::uint64_t zip64_from = 0xffffffffu) {
  ZipWriter zip(path, zip64_from);
  for (std::size_t i = 0; i < count; ++i) zip.add(name_of(i), name_of(i) + name_of(i) + name_of(i));
  zip.commit();
}

TEST(ZipFile, OthersReadIt) {
  const tests::ScratchFolder folder;
  for (const std::size_t count : {1u, 17u}) {
    write_entries(folder / "a.zip", count);
    EXPECT_EQ(python_says(folder / "a.zip", count), 0);
    const ZipReader zip(folder / "a.zip");
    ASSERT_EQ(zip.entries().size(), count);
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(zip.read(i, 1000).substr(0, name_of(i).size()), name_of(i));
  }
}

TEST(ZipFile, PlacesAndSizesBeyondTheFormatsLimitTakeItsWideFields) {
  const tests::ScratchFolder folder;
  for (const std::uint64_t from : {1u, 40u, 70u, 700u}) {
    write_entries(folder / "wide.zip", 20, from);
    EXPECT_EQ(python_says(folder / "wide.zip", 20), 0) << from;
    const ZipReader zip(folder / "wide.zip");
    ASSERT_EQ(zip.entries().size(), 20u) << from;
    EXPECT_EQ(zip.read(19, 1000).size(), 3 * name_of(19).size());
  }
}

TEST(ZipFile, MoreThan65535Entries) {
  const tests::ScratchFolder folder;
  write_entries(folder / "many.zip", 66000);
  EXPECT_EQ(python_says(folder / "many.zip", 66000), 0);
  const ZipReader zip(folder / "many.zip");
  ASSERT_EQ(zip.entries().size(), 66000u);
  EXPECT_EQ(zip.read(65999, 1000).substr(0, name_of(65999).size()), name_of(65999));
}

TEST(ZipFile, NamesThatLeaveItAndTwinsAreRefused) {
  const tests::ScratchFolder folder;
  for (const char* name : {"../a.png", "/etc/passwd", "a/../../b", "c:\\a", ".."}) {
    ZipWriter zip(folder / "bad.zip");
    zip.add(name, "x");
    zip.commit();
    EXPECT_THROW(ZipReader(folder / "bad.zip"), Error) << name;
  }
  ZipWriter zip(folder / "twins.zip");
  zip.add("a", "x"), zip.add("a", "y");
  zip.commit();
  EXPECT_THROW(ZipReader(folder / "twins.zip"), Error);
}

TEST(ZipFile, LengthIsAskedBeforeItIsBelieved) {
  const tests::ScratchFolder folder;
  write_entries(folder / "a.zip", 2);
  const ZipReader zip(folder / "a.zip");
  EXPECT_THROW(zip.read(0, 5), Error);
  EXPECT_EQ(zip.beginning(0, 6), "folder");
}

}  // namespace
}  // namespace gonio::io
