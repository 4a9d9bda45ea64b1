// See fault.h. Whatever a handler calls is safe in a signal (signal-safety(7)): write, unlink, _exit and lock-free
// atomics; the text is put together in a fixed buffer, the names are copied beforehand.
#include "base/fault.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>

#include "base/error.h"
#include "base/progress.h"
#include "base/temporaries.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GONIO_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define GONIO_SANITIZED 1
#endif
#endif

namespace gonio {
namespace {

#ifdef GONIO_SANITIZED
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

struct Fault {
  int signal;
  const char* meaning;
};
constexpr std::array<Fault, 5> faults{{
    {SIGSEGV, "memory that is not the program's, or a stack that overflowed (SIGSEGV)"},
    {SIGBUS, "memory that is not there, as of a file that was cut (SIGBUS)"},
    {SIGFPE, "arithmetic that has no result, as a division by zero (SIGFPE)"},
    {SIGILL, "an instruction that this processor does not know, or code that must not be reached (SIGILL)"},
    {SIGABRT, "the program gave itself up (SIGABRT)"},
}};

constexpr std::size_t longest_name = 64, longest_line = 1024;
std::array<char, longest_name> faulty_program{"gonio"};
bool stderr_is_terminal = false, handlers_installed = false;
std::atomic<long> reporting_thread{0};
static_assert(std::atomic<long>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

// One line in a fixed buffer; what does not fit is cut.
class FaultLine {
 public:
  void add(const char* text) noexcept { add(text, std::strlen(text)); }
  void add(const char* text, std::size_t length) noexcept {
    for (std::size_t i = 0; i < length && length_ + 1 < text_.size(); ++i)
      text_[length_++] = text[i] == '\n' ? ' ' : text[i];
  }
  void add(unsigned number) noexcept {
    std::array<char, 12> digits{};
    std::size_t first = digits.size();
    do digits[--first] = static_cast<char>('0' + number % 10);
    while ((number /= 10) > 0);
    add(digits.data() + first, digits.size() - first);
  }
  void write() noexcept {
    text_[length_++] = '\n';
    for (std::size_t done = 0; done < length_;) {
      const auto written = ::write(STDERR_FILENO, text_.data() + done, length_ - done);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return;  // nobody is left to be told
      done += static_cast<std::size_t>(written);
    }
  }

 private:
  std::array<char, longest_line> text_{};
  std::size_t length_ = 0;
};

[[noreturn]] void leave_with_internal() noexcept {
  ::_exit(static_cast<int>(Exit::internal));
}

// The first thread that gets here reports; others wait for its end, and a fault within the report ends it at once.
void become_the_reporter() noexcept {
  const long self = ::syscall(SYS_gettid);
  long nobody = 0;
  if (reporting_thread.compare_exchange_strong(nobody, self)) return;
  if (nobody == self) leave_with_internal();
  while (true) ::pause();
}

// `meaning`: parts that are written one behind the other.
template <class... Parts>
[[noreturn]] void report_fault(Parts... meaning) noexcept {
  become_the_reporter();
  remove_temporaries();
  FaultLine line;
  if (stderr_is_terminal) line.add("\r\x1b[K");  // a progress bar may stand there
  line.add(faulty_program.data());
  line.add(": internal fault: ");
  (line.add(meaning), ...);
  line.add("; please report it with the call that led to it");
  line.write();
  leave_with_internal();
}

extern "C" void on_fault(int signal) {
  const auto found =
      std::find_if(faults.begin(), faults.end(), [signal](const Fault& f) { return f.signal == signal; });
  report_fault(found == faults.end() ? "a signal" : found->meaning);
}

[[noreturn]] void on_terminate() noexcept {
  try {
    if (const std::exception_ptr nobody_caught = std::current_exception()) std::rethrow_exception(nobody_caught);
  } catch (const std::bad_alloc&) {
    report_fault("not enough memory, where nothing can be done about it");
  } catch (const std::exception& e) {
    report_fault(e.what(), " (an exception that nobody catches)");
  } catch (...) {
    report_fault("an exception that nobody catches");
  }
  report_fault("the program gave itself up (std::terminate)");
}

// The second stack of one thread, unmapped when the thread ends.
class SignalStack {
 public:
  SignalStack() {
    const long least = ::sysconf(_SC_SIGSTKSZ);
    size_ = std::max<std::size_t>(std::size_t{1} << 16, least > 0 ? static_cast<std::size_t>(least) : 0);
    memory_ = ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) return;  // then an overflow ends as the kernel ends it
    stack_t stack{};
    stack.ss_sp = memory_;
    stack.ss_size = size_;
    ::sigaltstack(&stack, nullptr);
  }
  ~SignalStack() {
    if (memory_ == MAP_FAILED) return;
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    ::sigaltstack(&none, nullptr);
    ::munmap(memory_, size_);
  }
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  void* memory_ = MAP_FAILED;
  std::size_t size_ = 0;
};

}  // namespace

void guard_stack_of_this_thread() {
  if constexpr (!sanitized) static thread_local const SignalStack stack;
}

void install_fault_handlers() {
  const std::string_view name = program_name();
  faulty_program.fill(0);
  std::copy_n(name.begin(), std::min(name.size(), longest_name - 1), faulty_program.begin());
  stderr_is_terminal = ::isatty(STDERR_FILENO) == 1;
  handlers_installed = true;
  std::set_terminate(on_terminate);
  if constexpr (sanitized) return;
  guard_stack_of_this_thread();
  struct sigaction action {};
  action.sa_handler = on_fault;
  action.sa_flags = SA_ONSTACK | SA_NODEFER;  // a fault within the report comes back to become_the_reporter()
  sigemptyset(&action.sa_mask);
  for (const Fault& fault : faults) ::sigaction(fault.signal, &action, nullptr);
}

}  // namespace gonio

#ifdef __GLIBC__
// The C library would print a line of its own before it aborts; ours says the same and what to do with it. Programs
// without install_fault_handlers() abort as ever.
extern "C" [[noreturn]] void __assert_fail(const char* assertion, const char* file, unsigned line,
                                           const char* /*function*/) noexcept {
  if (gonio::handlers_installed) gonio::report_fault("\"", assertion, "\" does not hold in ", file, ":", line);
  gonio::FaultLine said;
  said.add("\""), said.add(assertion), said.add("\" does not hold in "), said.add(file), said.add(":"), said.add(line);
  said.write();
  std::abort();
}
#endif
