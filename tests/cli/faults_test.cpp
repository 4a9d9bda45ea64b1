// The shipped programs turn an internal fault into one line and exit code 70; memory that is lacking, too.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include "cli/program.h"
#include "data.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::MatchesRegex;

// Has the process a handler for this signal?
bool handles(pid_t process, int signal) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0;
  return false;
}

TEST(Faults, OfAShippedProgramAreOneLineAndSeventy) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer reports these";
#endif
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    int pipe[2];
    ASSERT_EQ(::pipe(pipe), 0);
    Process program({"compare"}, {}, {}, [&] {  // waits for a manifest that nobody writes
      ::dup2(pipe[0], 0);
      const rlimit no_core{0, 0};
      ::setrlimit(RLIMIT_CORE, &no_core);
    });
    for (int i = 0; i < 2000 && !handles(program.id(), signal); ++i) ::usleep(5000);
    ::kill(program.id(), signal);
    const Ended ended = program.end();
    ::close(pipe[0]), ::close(pipe[1]);
    EXPECT_EQ(ended.status, 70) << signal;
    EXPECT_EQ(ended.out, "");
    EXPECT_THAT(ended.err,
                MatchesRegex("compare: internal fault: [^\n]*; please report it with the call that led to it\n"));
  }
}

// What a program does that asks for more memory than there is.
TEST(Faults, MemoryThatIsLackingIsOneLineAndSeventy) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer reports it";
#endif
  cli::Program greedy;
  greedy.name = "greedy";
  greedy.reads = cli::Reads::none;
  greedy.run = [](cli::Invocation&) {
    const std::vector<double> all(std::size_t{1} << 46, 1.0);
    return all.back() > 0 ? Exit::done : Exit::negative;
  };
  const int err = detail::memory_file({});
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(err, STDERR_FILENO);
    std::string name = "greedy";
    char* argv[] = {name.data(), nullptr};
    ::_exit(cli::main(greedy, 1, argv));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 70);
  EXPECT_THAT(detail::content_of(err), MatchesRegex("greedy: not enough memory; [^\n]*\n"));
}

}  // namespace
}  // namespace gonio::tests
