// Whole or not at all: under a full disk, a read-only folder, a signal and kill -9.
#include "base/atomic_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "data.h"

namespace gonio {
namespace {

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  return names;
}

Exit code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.code();
  }
  return Exit::done;
}

// Exit status of `action` in a process of its own: the Error's code, 0 without one, 128 + N where signal N ended it.
int status_in_child(const std::function<void()>& action) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(static_cast<int>(code_of(action)));
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

TEST(AtomicFile, WritesAndReplacesAndReads) {
  const tests::ScratchFolder folder;
  const auto path = folder / "a.txt";
  write_file(path, "first");
  write_file(path, "second");
  EXPECT_EQ(read_file(path), "second");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a.txt"));
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  EXPECT_EQ(status.st_mode & 0777, 0666 & ~mask);
}

TEST(AtomicFile, FollowsLinksAndWritesIntoDevices) {
  const tests::ScratchFolder folder;
  write_file(folder / "real", "old");
  std::filesystem::create_symlink("real", folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "real"), "new");
  write_file("/dev/null", "gone");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(AtomicFile, WritingThroughALibraryKeepsTheExtensionAndRemovesAFailure) {
  const tests::ScratchFolder folder;
  const auto path = folder / "picture.exr";
  write_file_through(path, [](const std::filesystem::path& temporary) {
    EXPECT_EQ(temporary.extension(), ".exr");
    std::ofstream(temporary) << "pixels";
  });
  EXPECT_EQ(read_file(path), "pixels");
  EXPECT_THROW(write_file_through(path, [](const auto&) { throw std::runtime_error("failed"); }), std::runtime_error);
  EXPECT_EQ(read_file(path), "pixels");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("picture.exr"));
}

TEST(AtomicFile, LongNamesWork) {
  const tests::ScratchFolder folder;
  const std::string name(251, 'n');
  write_file(folder / (name + ".txt"), "x");
  EXPECT_EQ(read_file(folder / (name + ".txt")), "x");
}

TEST(AtomicFile, RefusalsHaveTheirExitCodes) {
  const tests::ScratchFolder folder;
  write_file(folder / "file", "x");
  EXPECT_EQ(code_of([&] { write_file(folder / "none/file", "x"); }), Exit::cannot_create);
  EXPECT_EQ(code_of([&] { write_file(folder / "file/below", "x"); }), Exit::cannot_create);
  EXPECT_EQ(code_of([&] { write_file(folder.path(), "x"); }), Exit::cannot_create);
  EXPECT_EQ(code_of([&] { check_writable(folder / "none/file"); }), Exit::cannot_create);
  EXPECT_EQ(code_of([&] { check_writable(folder.path()); }), Exit::cannot_create);
  EXPECT_EQ(code_of([&] { check_writable(folder / "file"); }), Exit::done);
  EXPECT_EQ(code_of([&] { check_writable(folder / "new"); }), Exit::done);
  EXPECT_EQ(code_of([&] { check_writable("/dev/null"); }), Exit::done);
  EXPECT_EQ(code_of([&] { make_folder(folder / "file"); }), Exit::cannot_create);
  EXPECT_EQ(code_of([&] { make_folder(folder / "file/below"); }), Exit::cannot_create);
  EXPECT_EQ(code_of([&] { make_folder(folder / "new/deep"); }), Exit::done);
  EXPECT_EQ(code_of([&] { make_folder(folder / "new/deep"); }), Exit::done);
  EXPECT_EQ(code_of([&] { read_file(folder / "none"); }), Exit::no_input);
  EXPECT_EQ(code_of([&] { read_file(folder.path()); }), Exit::no_input);
  EXPECT_EQ(code_of([&] { read_file(folder / "file", 0); }), Exit::data);
  EXPECT_EQ(code_of([&] { sha256_of_file(folder / "none"); }), Exit::no_input);
}

TEST(AtomicFile, AFolderThatMayNotBeWrittenTo) {
  const tests::ScratchFolder folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 0555), 0);
  const int status = status_in_child([&] {
    if (::geteuid() == 0 && ::setuid(65534) != 0) throw Error(Exit::internal, "test", "setuid failed");
    write_file(folder / "a", "x");
  });
  ::chmod(folder.path().c_str(), 0755);
  EXPECT_EQ(status, 73);
}

// A file-size limit stands for a full disk: the kernel refuses the write midway in the same manner.
TEST(AtomicFile, AFullDiskLeavesWhatWasThere) {
  const tests::ScratchFolder folder;
  write_file(folder / "a", "before");
  const int status = status_in_child([&] {
    install_signal_handlers();
    const rlimit limit{100000, 100000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    write_file(folder / "a", std::string(1 << 20, 'x'));
  });
  EXPECT_EQ(status, 74);
  EXPECT_EQ(read_file(folder / "a"), "before");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a"));
}

TEST(AtomicFile, ASignalEndsALoopWithTryAgainAndRemovesTemporaries) {
  const tests::ScratchFolder folder;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    const int status = status_in_child([&] {
      install_signal_handlers();
      set_threads(2);
      write_file_through(folder / "a.bin", [&](const auto&) {
        parallel_for(0, 1000000, [&](std::size_t i) {
          if (i == 100) ::raise(signal);
        });
      });
    });
    EXPECT_EQ(status, 75);
    EXPECT_THAT(names_in(folder.path()), testing::IsEmpty());
  }
}

TEST(AtomicFile, ASecondSignalEndsAtOnce) {
  const tests::ScratchFolder folder;
  const int status = status_in_child([&] {
    install_signal_handlers();
    write_file_through(folder / "a.bin", [&](const auto&) {
      ::raise(SIGTERM);
      ::raise(SIGTERM);
      ::pause();
    });
  });
  EXPECT_EQ(status, 75);
  EXPECT_THAT(names_in(folder.path()), testing::IsEmpty());
}

TEST(AtomicFile, NothingIsWrittenAfterAnInterrupt) {
  const tests::ScratchFolder folder;
  const int status = status_in_child([&] {
    install_signal_handlers();
    ::raise(SIGTERM);
    write_file(folder / "a", "x");
  });
  EXPECT_EQ(status, 75);
  EXPECT_THAT(names_in(folder.path()), testing::IsEmpty());
}

// Killed again and again while it replaces a file: there is always one whole version, and nothing lies beside it.
TEST(AtomicFile, KilledAtAnyMomentOneWholeVersionStands) {
  const tests::ScratchFolder folder;
  const auto path = folder / "a";
  constexpr std::size_t length = 300000;
  write_file(path, std::string(length, 'a'));
  int leftovers = 0;
  for (int round = 0; round < 30; ++round) {
    const pid_t child = ::fork();
    if (child == 0)
      for (char letter = 'a';; letter = letter == 'z' ? 'a' : static_cast<char>(letter + 1))
        write_file(path, std::string(length, letter));
    ::usleep(static_cast<useconds_t>(1000 + 700 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::string bytes = read_file(path);
    ASSERT_EQ(bytes, std::string(length, bytes[0]));
    for (const auto& name : names_in(folder.path()))
      if (name != "a") {
        ++leftovers;
        EXPECT_EQ(std::filesystem::file_size(folder / name), length) << "a half-written " << name;
        std::filesystem::remove(folder / name);
      }
  }
  EXPECT_LE(leftovers, 3) << "the moment between link and rename is short";
}

TEST(Hash, KnownAnswers) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const tests::ScratchFolder folder;
  const std::string million(1000000, 'a');
  write_file(folder / "million", million);
  EXPECT_EQ(sha256_of_file(folder / "million"), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(sha256(million), sha256_of_file(folder / "million"));
}

}  // namespace
}  // namespace gonio
