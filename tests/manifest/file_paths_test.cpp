// The rule of paths, one test per case: none depends on where the source tree, the working directory or the folder for
// temporary files lie.
#include "manifest/file_paths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "manifest/sections/file.h"

namespace gonio::manifest {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// The working directory for as long as this lives.
class Within {
 public:
  explicit Within(const fs::path& folder) { fs::current_path(folder); }
  ~Within() { fs::current_path(before_); }
  Within(const Within&) = delete;
  Within& operator=(const Within&) = delete;

 private:
  fs::path before_ = fs::current_path();
};

class FilePaths : public testing::Test {
 protected:
  FilePaths() {
    for (const char* folder : {"x/gonio/build", "x/set", "xy"}) fs::create_directories(root_ / folder);
    for (const char* file : {"x/set/in.txt", "x/next.txt", "xy/near.txt"}) write_file(root_ / file, file);
  }
  fs::path at(const std::string& name) const { return root_ / name; }
  static Document naming(const std::string& entry, const fs::path& folder, bool allow_outside = false) {
    return parse_document(R"({"gonio": 1, "files": {"f": {"path": ")" + entry + R"("}}})", "m.json", folder,
                          {.allow_outside = allow_outside});
  }
  static fs::path found(const Document& document) { return fs::canonical(resolve(document, "f", "/meshes/m/file")); }
  static void expect_refused(const Document& document) {
    try {
      FAIL() << resolve(document, "f", "/meshes/m/file") << " was accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      EXPECT_THAT(e.what(), HasSubstr("#/files/f/path: \"" + document.files.at("f").path +
                                      "\" leaves the manifest's folder; move the file, or allow it with "));
    }
  }

 private:
  tests::ScratchFolder scratch_;

 protected:
  const fs::path root_ = fs::canonical(scratch_.path());
};

TEST_F(FilePaths, AbsoluteWithinTheFolder) {
  EXPECT_EQ(found(naming(at("x/set/in.txt"), at("x/set"))), at("x/set/in.txt"));
}

TEST_F(FilePaths, AbsoluteOutsideIsRefused) {
  expect_refused(naming(at("x/next.txt"), at("x/set")));
}

TEST_F(FilePaths, RelativeThatComesBackIsWithin) {
  EXPECT_EQ(found(naming("../set/./in.txt", at("x/set"))), at("x/set/in.txt"));
  EXPECT_EQ(found(naming("none/../in.txt", at("x/set"))), at("x/set/in.txt"));
}

TEST_F(FilePaths, RelativeThatLeavesIsRefused) {
  expect_refused(naming("../next.txt", at("x/set")));
  expect_refused(naming("a/../../next.txt", at("x/set")));
}

TEST_F(FilePaths, AFolderWhoseNameBeginsAlikeIsOutside) {
  expect_refused(naming("../xy/near.txt", at("x")));
  expect_refused(naming(at("xy/near.txt"), at("x")));
  EXPECT_FALSE(lies_within(at("xy/near.txt"), at("x")));
  EXPECT_FALSE(lies_within(at("x/near.txt"), at("xy")));
}

TEST_F(FilePaths, ANameThatBeginsWithDotsIsNoWayOut) {
  write_file(at("x/set/..odd"), "odd");
  EXPECT_EQ(found(naming("..odd", at("x/set"))), at("x/set/..odd"));
}

TEST_F(FilePaths, OutsideIsTakenWhereItIsAllowed) {
  EXPECT_EQ(found(naming("../next.txt", at("x/set"), true)), at("x/next.txt"));
  EXPECT_EQ(found(naming(at("xy/near.txt"), at("x/set"), true)), at("xy/near.txt"));
}

TEST_F(FilePaths, AFolderThatIsALinkIsTheFolderThatItNames) {
  fs::create_directory_symlink(at("x/set"), at("link"));
  EXPECT_EQ(found(naming("in.txt", at("link"))), at("x/set/in.txt"));
  EXPECT_EQ(found(naming(at("x/set/in.txt"), at("link"))), at("x/set/in.txt"));
  EXPECT_EQ(found(naming(at("link/in.txt"), at("x/set"))), at("x/set/in.txt"));
  // ".." by letters: beside the link, not beside what it names.
  write_file(at("beside.txt"), "beside");
  EXPECT_EQ(found(naming("../beside.txt", at("link"), true)), at("beside.txt"));
  expect_refused(naming("../beside.txt", at("link")));
}

TEST_F(FilePaths, ALinkThatLeadsOutOfTheFolderIsRefused) {
  fs::create_symlink(at("x/next.txt"), at("x/set/way-out.txt"));
  fs::create_directory_symlink(at("xy"), at("x/set/other"));
  expect_refused(naming("way-out.txt", at("x/set")));
  expect_refused(naming("other/near.txt", at("x/set")));
  EXPECT_EQ(found(naming("way-out.txt", at("x/set"), true)), at("x/next.txt"));
}

TEST_F(FilePaths, StandardInputStartsAtTheWorkingDirectory) {
  const Within here(at("x/set"));
  const auto from_pipe = [](const std::string& entry) {
    return parse_document(R"({"gonio": 1, "files": {"f": {"path": ")" + entry + R"("}}})", "standard input", ".");
  };
  EXPECT_EQ(found(from_pipe("in.txt")), at("x/set/in.txt"));
  EXPECT_EQ(found(from_pipe(at("x/set/in.txt"))), at("x/set/in.txt"));
  expect_refused(from_pipe("../next.txt"));
}

TEST_F(FilePaths, TheRootIsAFolderLikeOthers) {
  EXPECT_TRUE(lies_within(at("x/next.txt"), "/"));
  EXPECT_EQ(place_of_entry("/a", "../../b"), "/b");
  EXPECT_EQ(entry_for("/a/b", "/"), "a/b");
}

// The same files and the same steps, wherever the working directory lies about the folder of the files.
TEST_F(FilePaths, AMovedDocumentNamesTheSameFilesFromEveryWorkingDirectory) {
  for (const char* working : {".", "x", "x/set", "x/gonio/build", "xy", "/", "/usr"}) {
    SCOPED_TRACE(working);
    const Within here(working[0] == '/' ? fs::path(working) : at(working));
    Document document;
    add_file(document, at("x/set/in.txt"), "f");
    add_file(document, at("xy/near.txt"), "near");
    move_to_folder(document, at("x/set"));
    EXPECT_EQ(document.files.at("f").path, "in.txt");
    EXPECT_EQ(found(document), at("x/set/in.txt"));
    EXPECT_THROW(resolve(document, "near", "/meshes/m/file"), Error);
    const Document read = parse_document(print_document(document, at("x/gonio")), "m.json", at("x/gonio"), {true});
    EXPECT_EQ(read.files.at("f").path, "../set/in.txt");
    EXPECT_EQ(found(read), at("x/set/in.txt"));
  }
}

// A working directory below the folder for temporary files, above it, and beside it: without a folder of its own a
// document starts at the working directory, and only what lies below that is within.
TEST_F(FilePaths, TemporaryFilesAreWithinWhereTheyLieBelow) {
  for (const auto& [working, within] :
       {std::pair{".", true}, {"x", true}, {"x/set", true}, {"x/gonio/build", false}, {"xy", false}}) {
    SCOPED_TRACE(working);
    const Within here(at(working));
    Document document;
    add_file(document, at("x/set/in.txt"), "f");
    if (within)
      EXPECT_EQ(found(document), at("x/set/in.txt"));
    else
      expect_refused(document);
    document.allow_outside = true;
    EXPECT_EQ(found(document), at("x/set/in.txt"));
  }
}

}  // namespace
}  // namespace gonio::manifest
