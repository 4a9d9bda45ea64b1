// A TCP connection to a device, with an end to every wait. Bytes in, bytes out; what they mean is the caller's matter.
// Lost is thrown where the connection cannot be believed any more (closed, reset, silent, nonsense): who catches it
// opens a new one or gives up, and never reads on.
#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

#include "acquisition/device/devices.h"

namespace gonio::acquisition {

struct Lost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Clock::time_point after(double seconds);

class Connection {
 public:
  Connection() = default;
  // Lost where nothing listens there. `what` is its name in messages: "RTDE at 10.0.0.2:30004".
  Connection(const std::string& host, int port, double timeout_s, std::string what);
  ~Connection() { close(); }
  Connection(Connection&& other) noexcept;
  Connection& operator=(Connection&& other) noexcept;

  bool is_open() const { return file_ >= 0; }
  const std::string& what() const { return what_; }
  void close();
  void send(std::string_view bytes, Clock::time_point until);
  std::string receive(std::size_t count, Clock::time_point until);  // exactly so many
  std::string line(std::size_t longest, Clock::time_point until);   // without its end
  void discard();  // what has come in; so that closing does not reset the peer before it has read what was sent

 private:
  void wait(short events, Clock::time_point until) const;
  int file_ = -1;
  std::string what_;
};

}  // namespace gonio::acquisition
