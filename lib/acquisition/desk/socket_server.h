// A small server on loopback: one thread that accepts, one a connection. The handler returns, or throws Gone, when it
// is done with its peer; all waits end when the server does.
#pragma once
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <functional>
#include <list>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include "base/error.h"

namespace gonio::acquisition::desk {

struct Gone {};  // the peer has closed, or the server ends

class Peer {
 public:
  Peer(int file, const std::atomic<bool>& ending) : file_(file), ending_(ending) {}
  ~Peer() {
    if (file_ >= 0) ::close(file_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  // Up to `most` bytes; empty where none came within the time.
  std::string read(std::size_t most, int milliseconds) {
    for (int waited = 0;;) {
      if (ending_) throw Gone{};
      pollfd wanted{file_, POLLIN, 0};
      const int step = std::min(milliseconds - waited, 20);
      const int ready = ::poll(&wanted, 1, step);
      if (ready < 0 && errno != EINTR) throw Gone{};
      if (ready > 0) break;
      waited += step;
      if (waited >= milliseconds) return {};
    }
    std::string bytes(most, '\0');
    const ssize_t got = ::recv(file_, bytes.data(), most, 0);
    if (got <= 0) throw Gone{};
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
  }
  std::string read_exactly(std::size_t count) {
    std::string bytes;
    while (bytes.size() < count) bytes += read(count - bytes.size(), 20);
    return bytes;
  }
  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) throw Gone{};
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  [[noreturn]] void reset() {  // the peer sees "connection reset"
    const linger at_once{1, 0};
    ::setsockopt(file_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::close(file_);
    file_ = -1;
    throw Gone{};
  }
  int file() const { return file_; }

 private:
  int file_;
  const std::atomic<bool>& ending_;
};

inline int listen_on_loopback(int port) {  // 0: any
  const int file = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::bind(file, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 || ::listen(file, 16) != 0) {
    ::close(file);
    throw Error(Exit::unavailable, "127.0.0.1:" + std::to_string(port), "the port is taken",
                "give another, or 0 for any");
  }
  return file;
}
inline int port_of(int file) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

class SocketServer {
 public:
  using Handler = std::function<void(Peer&)>;
  SocketServer(int port, Handler handler) : handler_(std::move(handler)), file_(listen_on_loopback(port)) {
    port_ = port_of(file_);
    accepting_ = std::thread([this] { accept_all(); });
  }
  ~SocketServer() {
    ending_ = true;
    accepting_.join();
    ::close(file_);
    for (auto& peer : peers_) peer.thread.join();
  }
  SocketServer(const SocketServer&) = delete;
  SocketServer& operator=(const SocketServer&) = delete;
  int port() const { return port_; }

 private:
  struct Served {
    std::thread thread;
    std::atomic<bool> over{false};
  };
  void accept_all() {
    while (!ending_) {
      for (auto peer = peers_.begin(); peer != peers_.end();) {
        if (!peer->over) {
          ++peer;
          continue;
        }
        peer->thread.join();
        peer = peers_.erase(peer);
      }
      pollfd wanted{file_, POLLIN, 0};
      if (::poll(&wanted, 1, 10) <= 0) continue;
      const int file = ::accept4(file_, nullptr, nullptr, SOCK_CLOEXEC);
      if (file < 0) continue;
      const int yes = 1;
      ::setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      Served& served = peers_.emplace_back();
      served.thread = std::thread([this, file, &served] {
        Peer peer(file, ending_);
        try {
          handler_(peer);
        } catch (const Gone&) {
        }
        served.over = true;
      });
    }
  }
  Handler handler_;
  int file_, port_ = 0;
  std::atomic<bool> ending_{false};
  std::list<Served> peers_;  // of the accepting thread; of the destructor once that has ended
  std::thread accepting_;
};

}  // namespace gonio::acquisition::desk
