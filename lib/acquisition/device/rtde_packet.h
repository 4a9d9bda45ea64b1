// Packets of Universal Robots' Real-Time Data Exchange, protocol version 2 (RTDE guide, "Protocol description"): size
// in two bytes (its own three-byte head included), type in one, payload; big-endian throughout. A packet whose payload
// is not exactly what its recipe says is refused: RtdeRefused, in words.
#pragma once
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace gonio::acquisition {

struct RtdeRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// 'V' protocol version, 'v' controller version, 'O' output recipe, 'S' start, 'P' pause, 'U' data, 'M' text.
std::string rtde_packet(char type, std::string_view payload);
struct RtdeHead {
  char type = 0;
  std::size_t payload_bytes = 0;
};
RtdeHead rtde_head(std::string_view three_bytes);

std::string rtde_version_request(int version);
std::string rtde_outputs_request(double frequency_hz, const std::vector<std::string>& names);
bool rtde_accepted(std::string_view payload);        // of 'V', 'S', 'P'
std::string rtde_text(std::string_view payload);     // of 'M': "source: message"
std::string rtde_version(std::string_view payload);  // of 'v': "5.8.0.0"

// What the controller answered to an output recipe.
struct RtdeRecipe {
  int id = 0;
  std::vector<std::string> names, types;
  std::size_t data_bytes = 0;  // of one data packet's payload, the recipe's id included
};
// Refused where the controller does not know one of the names: they are listed.
RtdeRecipe rtde_recipe(std::string_view payload, const std::vector<std::string>& names);

// Numbers by name: one, three or six. Integers of 64 bits beyond 2^53 lose their last digits.
using RtdeFields = std::map<std::string, std::vector<double>>;
RtdeFields rtde_fields(std::string_view payload, const RtdeRecipe& recipe);

}  // namespace gonio::acquisition
