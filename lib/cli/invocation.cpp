#include "cli/invocation.h"

#include <algorithm>

#include "base/error.h"

namespace gonio::cli {
namespace {

const Argument& argument(const Invocation::State& state, const std::string& name) {
  const auto found = state.arguments.find(name);
  if (found == state.arguments.end())
    throw Error(Exit::internal, state.program->name, "asks for the option --" + name + ", which it does not describe");
  return found->second;
}

}  // namespace

bool Invocation::given(const std::string& option) const {
  return argument(*state, option).given;
}
bool Invocation::flag(const std::string& option) const {
  return given(option);
}

double Invocation::number(const std::string& option) const {
  const Argument& a = argument(*state, option);
  if (a.numbers.empty()) throw Error(Exit::usage, "--" + option, "is missing", a.option->help);
  return a.numbers.front();
}
std::int64_t Invocation::integer(const std::string& option) const {
  return static_cast<std::int64_t>(number(option));
}

const std::string& Invocation::text(const std::string& option) const {
  const Argument& a = argument(*state, option);
  if (a.texts.empty()) throw Error(Exit::usage, "--" + option, "is missing", a.option->help);
  return a.texts.front();
}
const std::vector<std::string>& Invocation::texts(const std::string& option) const {
  return argument(*state, option).texts;
}

std::filesystem::path Invocation::output_path(const std::string& name) const {
  if (out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for " + name);
  const std::filesystem::path path = out / name;
  if (std::filesystem::exists(path) && !force && !resume)
    throw Error(Exit::cannot_create, path.string(), "exists", "--force replaces it");
  state->outputs.push_back(path);
  return path;
}

void Invocation::note_input(const std::filesystem::path& path) {
  if (std::ranges::find(state->inputs, path) == state->inputs.end()) state->inputs.push_back(path);
}

}  // namespace gonio::cli
