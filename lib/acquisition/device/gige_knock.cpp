#include "acquisition/device/gige_knock.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <thread>

#include "acquisition/device/connection.h"

namespace gonio::acquisition {
namespace {

constexpr std::array<std::uint8_t, 8> discovery_bytes{0x42, 0x01, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01};  // request 1
constexpr std::array<std::uint8_t, 4> found_bytes{0x00, 0x00, 0x00, 0x03};  // success, DISCOVERY_ACK

bool is_found(const std::uint8_t* bytes, std::int64_t count) {
  return count >= 8 && std::equal(found_bytes.begin(), found_bytes.end(), bytes) && bytes[6] == 0 && bytes[7] == 1;
}

bool answers_once(int file, Clock::time_point until) {
  ::send(file, discovery_bytes.data(), discovery_bytes.size(), MSG_NOSIGNAL);
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd wanted{file, POLLIN, 0};
    if (left <= 0 || ::poll(&wanted, 1, static_cast<int>(left)) <= 0) return false;
    std::array<std::uint8_t, 1024> answer{};
    const ssize_t count = ::recv(file, answer.data(), answer.size(), MSG_DONTWAIT);
    if (is_found(answer.data(), count)) return true;
    if (count >= 0) continue;
    // Refused (ICMP), which is no answer: a camera that boots refuses.
    std::this_thread::sleep_for(std::chrono::milliseconds(std::min<std::int64_t>(left, 20)));
    return false;
  }
}

}  // namespace

bool answers_as_gige_camera(const std::string& address, double timeout_s, int port) {
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, address.c_str(), &there.sin_addr) != 1) return true;
  const int file = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (file < 0) return true;
  bool found = false;
  // Connected, so that nobody else's answer is heard.
  if (::connect(file, reinterpret_cast<const sockaddr*>(&there), sizeof there) == 0) {
    const auto give_up = after(timeout_s);
    while (!found && Clock::now() < give_up)
      found = answers_once(file, std::min(give_up, after(std::min(timeout_s / 4, 0.5))));
  }
  ::close(file);
  return found;
}

}  // namespace gonio::acquisition
