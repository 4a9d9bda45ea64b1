// One call of a program while it runs: what was typed, typed and checked. Private to this folder.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "cli/program.h"

namespace gonio::cli {

struct Argument {
  const Option* option = nullptr;
  bool given = false;
  std::vector<std::string> texts;  // as typed, or the preset
  std::vector<double> numbers;     // integer, number, quantity: SI
};

struct Invocation::State {
  const Program* program = nullptr;
  std::vector<Option> options;                         // common and own; stable once parsing has begun
  std::map<std::string, Argument> arguments;           // by long name or operand's metavar
  std::vector<std::filesystem::path> inputs;           // files read besides the manifest
  mutable std::vector<std::filesystem::path> outputs;  // asked for with output_path()
};

// Fills `state.arguments` from the command line: types, ranges, choices, conflicts. Error(usage) at the option.
void parse_arguments(Invocation::State& state, int argc, char** argv);

}  // namespace gonio::cli
