// Children that are driven into every internal fault end with one line and 70, whatever the fault and the thread, and
// leave nothing half-written.
#include "base/fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Core>
#include <atomic>
#include <cassert>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "data.h"

#if defined(__SANITIZE_ADDRESS__)
#define GONIO_SANITIZER_REPORTS 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define GONIO_SANITIZER_REPORTS 1
#endif
#endif

namespace gonio {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

struct Ended {
  int status = 0;  // exit status, or 128 + N where signal N ended it
  std::string err;
};

Ended in_child(const std::function<void()>& body) {
  const int err = ::memfd_create("gonio-fault", 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(err, STDERR_FILENO);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    set_program_name("explain");
    install_signal_handlers();
    install_fault_handlers();
    body();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  std::string said(static_cast<std::size_t>(::lseek(err, 0, SEEK_END)), '\0');
  EXPECT_EQ(::pread(err, said.data(), said.size(), 0), static_cast<ssize_t>(said.size()));
  ::close(err);
  return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), said};
}

// Values that the optimizer does not know.
volatile int zero = 0, seven = 7;
int* volatile nowhere = nullptr;

// Deeper than any stack; the frames must be kept.
[[gnu::noinline]] int fall(int depth) {  // NOLINT: without end, as it should be
  volatile char frame[4096];
  frame[static_cast<std::size_t>(depth) % sizeof frame] = static_cast<char>(depth);
  if (depth == std::numeric_limits<int>::max()) return frame[0];
  return fall(depth + 1) + frame[static_cast<std::size_t>(depth) % sizeof frame];
}

void divide() {
  zero = seven / zero;
  ::raise(SIGFPE);  // where processors divide by zero without a word
}

void throw_two_lines() {
  throw std::runtime_error("two\nlines");
}
void throw_from_noexcept() noexcept {
  throw_two_lines();
}

void read_behind_the_end_of_a_file() {
  const int file = ::memfd_create("gonio-cut", 0);
  if (::ftruncate(file, 4096) != 0) return;
  const auto* mapped = static_cast<volatile char*>(::mmap(nullptr, 4096, PROT_READ, MAP_SHARED, file, 0));
  if (::ftruncate(file, 0) != 0) return;
  zero = mapped[0];
}

struct Case {
  const char* name;
  std::function<void()> fault;
  const char* said;  // part of the line
  bool of_sanitizers = true;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"Segmentation", [] { *nowhere = 1; }, "SIGSEGV"},
      {"Bus", read_behind_the_end_of_a_file, "SIGBUS"},
      {"Division", [] { divide(); }, "SIGFPE"},
      {"Illegal", [] { ::raise(SIGILL); }, "SIGILL"},
      {"Abort", [] { std::abort(); }, "SIGABRT"},
      {"StackOverflow", [] { zero = fall(0); }, "a stack that overflowed"},
      {"StackOverflowOfAWorker",
       [] {
         set_threads(2);
         parallel_for(0, 64, [](std::size_t i) { zero = fall(static_cast<int>(i)); });
       },
       "a stack that overflowed"},
      {"DivisionInAWorker",
       [] {
         set_threads(2);
         parallel_for(0, 64, [](std::size_t) { divide(); });
       },
       "SIGFPE"},
      {"EveryThreadAtOnce",
       [] {
         std::vector<std::thread> threads;
         for (int i = 0; i < 8; ++i) threads.emplace_back([] { *nowhere = 1; });
         for (auto& t : threads) t.join();
       },
       "SIGSEGV"},
      {"Terminate", [] { std::terminate(); }, "std::terminate", false},
      {"ExceptionThatNobodyCatches", throw_from_noexcept, "internal fault: two lines (an exception", false},
      {"ExceptionThatLeavesAThread", [] { std::thread([] { throw std::out_of_range("row 7 of 5"); }).join(); },
       "internal fault: row 7 of 5 (an exception", false},
      {"ThatIsNoException", [] { std::thread([] { throw 7; }).join(); }, "an exception that nobody catches", false},
      {"MemoryInAThread", [] { std::thread([] { throw std::bad_alloc(); }).join(); }, "not enough memory", false},
      {"Assertion", [] { assert(zero == 1); }, "\"zero == 1\" does not hold in ", false},
      {"EigenAssertion", [] { zero = static_cast<int>(Eigen::VectorXd::Zero(1).eval()(5 + zero)); },
       "does not hold in ", false},
  };
  return all;
}

class Fault : public testing::TestWithParam<std::size_t> {};

TEST_P(Fault, EndsWithOneLineAndSeventy) {
  const Case& c = cases()[GetParam()];
#ifdef GONIO_SANITIZER_REPORTS
  if (c.of_sanitizers) GTEST_SKIP() << "the sanitizer reports this one";
#endif
  const Ended ended = in_child(c.fault);
  EXPECT_EQ(ended.status, 70);
  EXPECT_THAT(ended.err,
              MatchesRegex("explain: internal fault: [^\n]*; please report it with the call that led to it\n"));
  EXPECT_THAT(ended.err, HasSubstr(c.said));
}
INSTANTIATE_TEST_SUITE_P(Every, Fault, testing::Range(std::size_t{0}, cases().size()),
                         [](const auto& index) { return cases()[index.param].name; });

TEST(FaultFiles, NothingIsLeftHalfWritten) {
#ifdef GONIO_SANITIZER_REPORTS
  GTEST_SKIP() << "the sanitizer reports this one";
#endif
  const tests::ScratchFolder folder;
  write_file(folder / "a.bin", "before");
  const Ended ended = in_child([&] {
    write_file_through(folder / "a.bin", [](const std::filesystem::path& temporary) {
      std::ofstream(temporary) << "half";
      divide();
    });
  });
  EXPECT_EQ(ended.status, 70);
  EXPECT_EQ(read_file(folder / "a.bin"), "before");
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 1);
}

TEST(FaultFiles, TheFirstSignalOfAUserStillEndsWithTryAgain) {
  const Ended ended = in_child([] {
    try {
      std::atomic<bool> raised = false;  // the work behind it waits, so that there is some left to be stopped
      parallel_for(0, 1000, [&](std::size_t i) {
        if (i == 10) {
          ::raise(SIGTERM);
          raised = true;
        }
        while (i > 10 && !raised) std::this_thread::yield();
      });
    } catch (const Error& e) {
      ::_exit(static_cast<int>(e.code()));
    }
  });
  EXPECT_EQ(ended.status, 75);
  EXPECT_EQ(ended.err, "");
}

}  // namespace
}  // namespace gonio
