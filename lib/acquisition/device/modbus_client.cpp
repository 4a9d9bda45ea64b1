#include "acquisition/device/modbus_client.h"

#include <modbus/modbus.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <functional>
#include <optional>
#include <thread>

#include "acquisition/device/connection.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

std::uint64_t joined_words(std::span<const std::uint16_t> words, WordOrder order) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < words.size(); ++i)
    bits = bits << 16 | words[order == WordOrder::high_first ? i : words.size() - 1 - i];
  return bits;
}

std::vector<std::uint16_t> split_words(std::uint64_t bits, std::size_t count, WordOrder order) {
  std::vector<std::uint16_t> words(count);
  for (std::size_t i = 0; i < count; ++i) {
    words[order == WordOrder::low_first ? i : count - 1 - i] = static_cast<std::uint16_t>(bits & 0xFFFF);
    bits >>= 16;
  }
  return words;
}

// What a device may answer instead of doing it: Modbus application protocol 1.1b3, section 7. `passes`: the same
// request may succeed later. A failure (04) is called unrecoverable there, but controllers send it while they start or
// are overloaded; all our requests may be repeated, so they are.
struct ModbusException {
  int wrong, code;
  bool passes;
  const char* remedy;
};
constexpr std::array modbus_exceptions{
    ModbusException{EMBXILFUN, 1, false, "the device cannot do this: is it a coil, a register, or for reading alone?"},
    ModbusException{EMBXILADD, 2, false, "the device has no such address: check the number and unit="},
    ModbusException{EMBXILVAL, 3, false, "the device does not take this value: check type and scale"},
    ModbusException{EMBXSFAIL, 4, true, "look what the device itself reports, and switch it off and on"},
    ModbusException{EMBXACK, 5, true, "the device needs longer for it: a longer timeout="},
    ModbusException{EMBXSBUSY, 6, true, "does another client keep it busy? else a longer timeout="},
    ModbusException{EMBXNACK, 7, false, "the device does not carry this out: look what it itself reports"},
    ModbusException{EMBXMEMPAR, 8, true, "the device cannot read its own memory: have it serviced"},
    ModbusException{EMBXGPATH, 10, true, "the gateway leads nowhere: check its set-up and unit="},
    ModbusException{EMBXGTAR, 11, true,
                    "the gateway gets no answer: is the device behind it on, and is unit= its own?"}};

// Null: libmodbus's errno is no exception, and the connection cannot be believed any more.
const ModbusException* exception_of(int wrong) {
  const auto found = std::ranges::find(modbus_exceptions, wrong, &ModbusException::wrong);
  return found == modbus_exceptions.end() ? nullptr : &*found;
}

}  // namespace

float float_of_words(std::span<const std::uint16_t> words, WordOrder order) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(joined_words(words, order)));
}
double double_of_words(std::span<const std::uint16_t> words, WordOrder order) {
  return std::bit_cast<double>(joined_words(words, order));
}
std::int32_t integer_of_words(std::span<const std::uint16_t> words, WordOrder order) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(joined_words(words, order)));
}
std::vector<std::uint16_t> words_of_float(float value, WordOrder order) {
  return split_words(std::bit_cast<std::uint32_t>(value), 2, order);
}
std::vector<std::uint16_t> words_of_double(double value, WordOrder order) {
  return split_words(std::bit_cast<std::uint64_t>(value), 4, order);
}
std::vector<std::uint16_t> words_of_integer(std::int32_t value, WordOrder order) {
  return split_words(static_cast<std::uint32_t>(value), 2, order);
}

struct ModbusClient::Context {
  modbus_t* open = nullptr;
  ~Context() { close(); }
  void close() {
    if (open == nullptr) return;
    modbus_close(open);
    modbus_free(open);
    open = nullptr;
  }
};

struct ModbusClient::Request {
  std::string what;                   // "coil 3"
  std::function<int(modbus_t*)> ask;  // libmodbus's answer: how many, or -1 and errno
  int expected;
};

ModbusClient::ModbusClient(ModbusAddress address, std::string place)
    : address_(std::move(address)), place_(std::move(place)), context_(std::make_unique<Context>()) {}
ModbusClient::~ModbusClient() = default;

// Sets errno where it fails, as libmodbus does.
void ModbusClient::open() {
  context_->open = modbus_new_tcp_pi(address_.host.c_str(), std::to_string(address_.port).c_str());
  if (context_->open == nullptr) return;
  const auto seconds = static_cast<std::uint32_t>(address_.timeout_s);
  const auto micros = static_cast<std::uint32_t>((address_.timeout_s - seconds) * 1e6);
  modbus_set_response_timeout(context_->open, seconds, micros);
  modbus_set_byte_timeout(context_->open, seconds, micros);
  if (modbus_set_slave(context_->open, address_.unit) == 0 && modbus_connect(context_->open) == 0) return;
  const int wrong = errno;
  context_->close();
  errno = wrong;
}

// An exception that may pass is waited out for the timeout, in pauses that grow; silence is met by another connection,
// `tries` of them.
void ModbusClient::perform(const Request& request) {
  const std::lock_guard<std::mutex> lock(one_at_a_time_);
  const std::string device = "Modbus at " + address_.host + ":" + std::to_string(address_.port);
  std::string problem;
  std::optional<Clock::time_point> give_up;  // after the first exception
  auto pause = std::chrono::milliseconds(1);
  for (int silent = 0, asked = 1; silent < address_.tries; ++asked) {
    if (context_->open == nullptr) {
      reconnections_ += silent > 0 ? 1 : 0;
      open();
    }
    if (context_->open == nullptr) {
      problem = std::string("cannot be reached: ") + modbus_strerror(errno);
      ++silent;
      continue;
    }
    modbus_flush(context_->open);
    const int got = request.ask(context_->open);
    if (got == request.expected) return;
    const int wrong = got < 0 ? errno : EMBBADDATA;
    problem = request.what + ": " + modbus_strerror(wrong);
    const ModbusException* exception = exception_of(wrong);
    if (exception == nullptr) {
      context_->close();  // a late answer would be read as the next one's
      ++silent;
      continue;
    }
    if (!give_up) give_up = after(address_.timeout_s);
    if (!exception->passes || Clock::now() >= *give_up)
      throw Error(Exit::unavailable, place_,
                  device + format(", unit %d, ", address_.unit) + problem +
                      format(" (exception %02d", exception->code) +
                      (exception->passes ? format(", asked %d times in %g s)", asked, address_.timeout_s) : ")"),
                  exception->remedy);
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds(100));
  }
  throw Error(Exit::unavailable, place_,
              device + ", " + problem + format(" (%d tries of %g s)", address_.tries, address_.timeout_s),
              "check that the device is on and the network leads there");
}

std::vector<bool> ModbusClient::bits(BitTable table, int first, int count) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(count));
  const bool coil = table == BitTable::coil;
  perform({std::string(coil ? "coil " : "discrete input ") + std::to_string(first),
           [&](modbus_t* device) {
             return coil ? modbus_read_bits(device, first, count, bytes.data())
                         : modbus_read_input_bits(device, first, count, bytes.data());
           },
           count});
  return {bytes.begin(), bytes.end()};
}

std::vector<std::uint16_t> ModbusClient::words(WordTable table, int first, int count) {
  std::vector<std::uint16_t> values(static_cast<std::size_t>(count));
  const bool holding = table == WordTable::holding;
  perform({std::string(holding ? "register " : "input register ") + std::to_string(first),
           [&](modbus_t* device) {
             return holding ? modbus_read_registers(device, first, count, values.data())
                            : modbus_read_input_registers(device, first, count, values.data());
           },
           count});
  return values;
}

void ModbusClient::write_bit(int coil, bool value) {
  perform({"writing coil " + std::to_string(coil),
           [&](modbus_t* device) { return modbus_write_bit(device, coil, value ? 1 : 0); }, 1});
}

void ModbusClient::write_words(int first, std::span<const std::uint16_t> values) {
  const int count = static_cast<int>(values.size());
  perform({"writing register " + std::to_string(first),
           [&](modbus_t* device) { return modbus_write_registers(device, first, count, values.data()); }, count});
}

}  // namespace gonio::acquisition
