// Programs run as a person would run them: arguments, standard input, exit status, what they print. For tests of tools;
// a folder that includes this and names GONIO_BIN waits for the programs to be built (tests/CMakeLists.txt).
#pragma once
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace gonio::tests {

struct Ended {
  int status = 0;  // exit status, or 128 + N where signal N ended the program
  std::string out, err;
};

namespace detail {

inline int memory_file(const std::string& content) {
  const int fd = ::memfd_create("gonio-test", 0);
  if (fd < 0 || ::write(fd, content.data(), content.size()) != static_cast<ssize_t>(content.size()))
    throw std::runtime_error("no memory file");
  ::lseek(fd, 0, SEEK_SET);
  return fd;
}

inline std::string content_of(int fd) {
  std::string content(static_cast<std::size_t>(::lseek(fd, 0, SEEK_END)), '\0');
  if (::pread(fd, content.data(), content.size(), 0) < 0) content.clear();
  ::close(fd);
  return content;
}

}  // namespace detail

// A program that has been started; end() waits for it.
class Process {
 public:
  using Words = std::vector<std::string>;
  // words[0] is looked up among the built programs first, then on the PATH. `before` runs in the child before the
  // program does: limits, user, working directory. The working directory is `folder` unless that is empty.
  explicit Process(const Words& words, const std::filesystem::path& folder = {}, const std::string& input = {},
                   const std::function<void()>& before = {})
      : in_(detail::memory_file(input)), out_(detail::memory_file({})), err_(detail::memory_file({})) {
    Words copy = words;
    const auto built = std::filesystem::path(GONIO_BIN) / copy.at(0);
    if (std::filesystem::exists(built)) copy[0] = built.string();
    std::vector<char*> argv;
    for (auto& word : copy) argv.push_back(word.data());
    argv.push_back(nullptr);
    child_ = ::fork();
    if (child_ != 0) return;
    ::dup2(in_, 0);
    ::dup2(out_, 1);
    ::dup2(err_, 2);
    if (!folder.empty() && ::chdir(folder.c_str()) != 0) ::_exit(126);
    if (before) before();
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  pid_t id() const { return child_; }
  Ended end() {
    int status = 0;
    ::waitpid(child_, &status, 0);
    ::close(in_);
    return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), detail::content_of(out_),
            detail::content_of(err_)};
  }

 private:
  int in_, out_, err_;
  pid_t child_ = -1;
};

inline Ended run(const Process::Words& words, const std::filesystem::path& folder = {}, const std::string& input = {},
                 const std::function<void()>& before = {}) {
  return Process(words, folder, input, before).end();
}

}  // namespace gonio::tests
