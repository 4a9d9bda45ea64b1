#include "acquisition/device/modbus_client.h"

#include <modbus/modbus.h>

#include <bit>
#include <cerrno>
#include <functional>

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

// The device answered, in order, that it will not: the connection is fine. The other errors leave it unknown.
bool is_exception(int wrong) {
  return wrong > MODBUS_ENOBASE && wrong < EMBBADCRC;
}
// Busy or not ready yet: the same request may succeed.
bool may_pass(int wrong) {
  return wrong == EMBXSBUSY || wrong == EMBXACK || wrong == EMBXGTAR;
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

void ModbusClient::perform(const Request& request) {
  const std::lock_guard<std::mutex> lock(one_at_a_time_);
  const std::string device = "Modbus at " + address_.host + ":" + std::to_string(address_.port);
  std::string problem;
  for (int attempt = 0; attempt < address_.tries; ++attempt) {
    if (context_->open == nullptr) {
      reconnections_ += attempt > 0 ? 1 : 0;
      open();
    }
    if (context_->open == nullptr) {
      problem = std::string("cannot be reached: ") + modbus_strerror(errno);
      continue;
    }
    modbus_flush(context_->open);
    const int got = request.ask(context_->open);
    if (got == request.expected) return;
    const int wrong = got < 0 ? errno : EMBBADDATA;
    problem = request.what + ": " + modbus_strerror(wrong);
    if (is_exception(wrong)) {
      if (may_pass(wrong)) continue;
      throw Error(Exit::unavailable, place_, device + ", unit " + std::to_string(address_.unit) + ", " + problem,
                  "the device answers, but not this: check the address and the unit");
    }
    context_->close();  // a late answer would be read as the next one's
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
