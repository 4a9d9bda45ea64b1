// A Modbus TCP device as this program talks to it: one request at a time, each answered in time or not at all. After a
// late or malformed answer the connection is dropped and the next request opens another: what arrives for an earlier
// question is never read as the answer to a later one. Repeating is harmless, all requests set or read states: they are
// repeated after silence (`tries`), and for the timeout where the device answers with an exception that may pass, as
// busy does. One that stays, as an address that it does not have, is an answer. Error(unavailable) in words: device,
// unit, address, exception, remedy.
//
// Numbers wider than a register are packed by own code (Modbus leaves it open): big-endian within a register, registers
// in the order that is said.
#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace gonio::acquisition {

enum class WordOrder { high_first, low_first };

// Two or four registers as IEEE 754 or two's complement. `words.size()` is 2, for double 4.
float float_of_words(std::span<const std::uint16_t> words, WordOrder order);
double double_of_words(std::span<const std::uint16_t> words, WordOrder order);
std::int32_t integer_of_words(std::span<const std::uint16_t> words, WordOrder order);
std::vector<std::uint16_t> words_of_float(float value, WordOrder order);
std::vector<std::uint16_t> words_of_double(double value, WordOrder order);
std::vector<std::uint16_t> words_of_integer(std::int32_t value, WordOrder order);
// 0xFFFF is -1: two's complement. (Several clients of UR's registers subtract 65535 and are off by one.)
constexpr int signed_word(std::uint16_t word) {
  return word < 0x8000 ? word : int{word} - 0x10000;
}

struct ModbusAddress {
  std::string host;
  int port = 502, unit = 1;
  double timeout_s = 2;
  int tries = 3;
};

enum class BitTable { coil, discrete };
enum class WordTable { holding, input };

class ModbusClient {
 public:
  ModbusClient(ModbusAddress address, std::string place);  // opens nothing yet
  ~ModbusClient();
  std::vector<bool> bits(BitTable table, int first, int count);
  std::vector<std::uint16_t> words(WordTable table, int first, int count);
  void write_bit(int coil, bool value);
  void write_words(int first, std::span<const std::uint16_t> values);
  std::int64_t reconnections() const { return reconnections_; }

 private:
  struct Context;
  struct Request;
  void perform(const Request& request);
  void open();
  ModbusAddress address_;
  std::string place_;
  std::unique_ptr<Context> context_;
  std::mutex one_at_a_time_;
  std::int64_t reconnections_ = 0;
};

}  // namespace gonio::acquisition
