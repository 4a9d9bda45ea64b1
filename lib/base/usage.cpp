#include "base/usage.h"

#include <sys/resource.h>

#include <chrono>

#include "base/text.h"

namespace gonio {

Usage usage_so_far() {
  rusage of{};
  getrusage(RUSAGE_SELF, &of);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
          seconds(of.ru_utime) + seconds(of.ru_stime), static_cast<double>(of.ru_maxrss) / 1024};
}

std::string usage_since(const Usage& before) {
  const Usage now = usage_so_far();
  return format("%.2f s, processor %.2f s, peak %.0f MiB", now.seconds - before.seconds,
                now.processor_seconds - before.processor_seconds, now.peak_mib);
}

}  // namespace gonio
