// See instrument_lock.h. unix(7): abstract sockets.
#include "acquisition/run/instrument_lock.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

// The bound socket; -1 where another has the name.
int bind_name(const std::string& url) {
  const std::string name = "gonio-instrument-" + sha256(url).substr(0, 32);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, name.data(), name.size());  // a leading zero: no file
  const int handle = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (handle < 0) throw Error(Exit::unavailable, url, std::strerror(errno));
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (::bind(handle, reinterpret_cast<const sockaddr*>(&address), size) == 0) return handle;
  const int why = errno;
  ::close(handle);
  if (why != EADDRINUSE) throw Error(Exit::unavailable, url, std::strerror(why));
  return -1;
}

}  // namespace

InstrumentLock::InstrumentLock(std::vector<std::string> urls, std::chrono::duration<double> wait) {
  using namespace std::chrono;
  std::ranges::sort(urls);
  urls.erase(std::unique(urls.begin(), urls.end()), urls.end());
  const auto until = steady_clock::now() + duration_cast<steady_clock::duration>(wait);
  try {
    for (const std::string& url : urls) {
      int handle = bind_name(url);
      while (handle < 0) {
        if (steady_clock::now() >= until)
          throw Error(Exit::try_again, url, format("is driven by another program (waited %.0f s)", wait.count()),
                      "wait longer (--wait 10min), or end the other");
        std::this_thread::sleep_for(milliseconds(50));
        throw_if_interrupted();
        handle = bind_name(url);
      }
      sockets_.push_back(handle);
    }
  } catch (...) {
    for (const int handle : sockets_) ::close(handle);
    throw;
  }
}

InstrumentLock::~InstrumentLock() {
  for (const int handle : sockets_) ::close(handle);
}

}  // namespace gonio::acquisition
