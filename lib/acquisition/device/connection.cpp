#include "acquisition/device/connection.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace gonio::acquisition {
namespace {

int milliseconds_until(Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
  if (left < 0) return 0;
  return static_cast<int>(std::min<long long>(left + 1, 1000 * 3600));
}

// 0, or the error number.
int connect_until(int file, const addrinfo& address, Clock::time_point until) {
  ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) | O_NONBLOCK);
  if (::connect(file, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd wanted{file, POLLOUT, 0};
  for (;;) {
    const int ready = ::poll(&wanted, 1, milliseconds_until(until));
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return ETIMEDOUT;
    if (ready < 0) return errno;
    break;
  }
  int wrong = 0;
  socklen_t size = sizeof wrong;
  ::getsockopt(file, SOL_SOCKET, SO_ERROR, &wrong, &size);
  return wrong;
}

}  // namespace

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

Connection::Connection(const std::string& host, int port, double timeout_s, std::string what) : what_(std::move(what)) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int wrong = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); wrong != 0)
    throw Lost(what_ + ": " + ::gai_strerror(wrong));
  int wrong = EADDRNOTAVAIL;
  const auto until = after(timeout_s);
  for (const addrinfo* address = found; address != nullptr && file_ < 0; address = address->ai_next) {
    const int file = ::socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (file < 0) continue;
    wrong = connect_until(file, *address, until);
    if (wrong == 0)
      file_ = file;
    else
      ::close(file);
  }
  ::freeaddrinfo(found);
  if (file_ < 0) throw Lost(what_ + ": " + std::strerror(wrong));
  const int yes = 1;
  ::setsockopt(file_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

Connection::Connection(Connection&& other) noexcept
    : file_(std::exchange(other.file_, -1)), what_(std::move(other.what_)) {}

Connection& Connection::operator=(Connection&& other) noexcept {
  if (this != &other) {
    close();
    file_ = std::exchange(other.file_, -1);
    what_ = std::move(other.what_);
  }
  return *this;
}

void Connection::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

void Connection::wait(short events, Clock::time_point until) const {
  if (file_ < 0) throw Lost(what_ + ": not connected");
  pollfd wanted{file_, events, 0};
  for (;;) {
    const int ready = ::poll(&wanted, 1, milliseconds_until(until));
    if (ready > 0) return;
    if (ready < 0 && errno != EINTR) throw Lost(what_ + ": " + std::strerror(errno));
    if (Clock::now() >= until) throw Lost(what_ + ": no answer in time");
  }
}

void Connection::send(std::string_view bytes, Clock::time_point until) {
  while (!bytes.empty()) {
    wait(POLLOUT, until);
    const ssize_t sent = ::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) throw Lost(what_ + ": " + std::strerror(errno));
    if (sent > 0) bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

std::string Connection::receive(std::size_t count, Clock::time_point until) {
  std::string bytes(count, '\0');
  std::size_t have = 0;
  while (have < count) {
    wait(POLLIN, until);
    const ssize_t got = ::recv(file_, bytes.data() + have, count - have, MSG_DONTWAIT);
    if (got == 0) throw Lost(what_ + ": closed by the device");
    if (got < 0 && errno != EAGAIN && errno != EINTR) throw Lost(what_ + ": " + std::strerror(errno));
    if (got > 0) have += static_cast<std::size_t>(got);
  }
  return bytes;
}

std::string Connection::line(std::size_t longest, Clock::time_point until) {
  std::string text;
  for (;;) {
    const char c = receive(1, until)[0];
    if (c == '\n') break;
    if (c != '\r') text += c;
    if (text.size() > longest) throw Lost(what_ + ": an answer without an end");
  }
  return text;
}

void Connection::discard() {
  char buffer[4096];
  while (file_ >= 0 && ::recv(file_, buffer, sizeof buffer, MSG_DONTWAIT) > 0) continue;
}

}  // namespace gonio::acquisition
