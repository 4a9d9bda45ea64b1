// See expression.h. muParser stays within this file.
#include "base/expression.h"

#include <muParser.h>

#include <numbers>

#include "base/error.h"

namespace gonio {
namespace {

// "=" alone would assign; ==, <=, >=, != compare.
void refuse_assignment(const std::string& text, const std::string& place) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool compares = (i > 0 && std::string("<>!=").find(text[i - 1]) != std::string::npos) ||
                          (i + 1 < text.size() && text[i + 1] == '=');
    if (!compares)
      throw Error(Exit::data, place, "\"" + text + "\" assigns at position " + std::to_string(i + 1),
                  "write the right-hand side alone: a*cos(theta)+b");
  }
}

[[noreturn]] void refuse(const mu::Parser::exception_type& e, const std::string& text, const std::string& place) {
  std::string message = e.GetMsg();
  while (message.ends_with('.') || message.ends_with('\n')) message.pop_back();
  for (char& c : message)
    if (c == '\n') c = ' ';
  throw Error(Exit::data, place, "\"" + text + "\" does not parse: " + message, "the manual lists what it may hold");
}

void set_constants(mu::Parser& parser) {
  parser.ClearConst();
  parser.DefineConst("pi", std::numbers::pi);
}

}  // namespace

struct Expression::Engine {
  mu::Parser parser;
  std::vector<double> variables;
};

Expression::Expression(std::string text, std::string place) : text_(std::move(text)), place_(std::move(place)) {
  if (text_.find_first_not_of(" \t") == std::string::npos)
    throw Error(Exit::data, place_, "is empty", "write a forward model: a*cos(theta)+b");
  refuse_assignment(text_, place_);
  try {
    mu::Parser parser;
    set_constants(parser);
    parser.SetExpr(text_);
    for (const auto& [name, variable] : parser.GetUsedVar()) names_.push_back(name);
    idle_.push_back(engine());
    idle_.back()->parser.Eval();  // syntax errors show here
  } catch (const mu::Parser::exception_type& e) {
    refuse(e, text_, place_);
  }
}

Expression::~Expression() = default;

std::unique_ptr<Expression::Engine> Expression::engine() const {
  auto engine = std::make_unique<Engine>();
  set_constants(engine->parser);
  engine->variables.assign(names_.size(), 1.0);
  for (std::size_t k = 0; k < names_.size(); ++k) engine->parser.DefineVar(names_[k], &engine->variables[k]);
  engine->parser.SetExpr(text_);
  return engine;
}

void Expression::evaluate(std::span<const double* const> columns, std::span<const double> constants, std::size_t first,
                          std::span<double> values) const {
  std::unique_ptr<Engine> engine;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      engine = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!engine) engine = this->engine();
  for (std::size_t k = 0; k < names_.size(); ++k)
    if (columns[k] == nullptr) engine->variables[k] = constants[k];
  try {
    for (std::size_t i = 0; i < values.size(); ++i) {
      for (std::size_t k = 0; k < names_.size(); ++k)
        if (columns[k] != nullptr) engine->variables[k] = columns[k][first + i];
      values[i] = engine->parser.Eval();
    }
  } catch (const mu::Parser::exception_type& e) {
    refuse(e, text_, place_);
  }
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(engine));
}

}  // namespace gonio
