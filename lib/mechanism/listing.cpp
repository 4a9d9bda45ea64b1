#include "mechanism/listing.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>
#include <utility>

#include "manifest/reference.h"

namespace gonio::mechanism {
namespace {

constexpr std::size_t width = 100;
constexpr std::array<std::pair<const char*, const char*>, 15> stages = {{
    {"light", "Lights: what leaves the lamps and reaches the scene"},
    {"transport", "Transport: light that arrives by way of other things"},
    {"surface", "Surfaces: what they send back"},
    {"volume", "Volumes: what happens inside"},
    {"geometry", "Geometry: where things are and how large"},
    {"pose", "Poses: robots, their joints and their links"},
    {"robot", "Robots"},
    {"board", "Boards: what a calibration target is and how it is found"},
    {"lens", "Lenses: where rays meet the sensor"},
    {"optics", "Optics: how much light goes there, and how sharply"},
    {"sensor", "Sensors: from light to numbers"},
    {"tracks", "Tracks: points that are followed through pictures"},
    {"tomograph", "Tomographs: X-rays, the detector, and what reconstruction makes of them"},
    {"print", "Prints: from grey values to heights"},
    {"reference", "References: what measurements are held against"},
}};

std::string number(double v) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", v);
  return digits;
}

std::string joined(const std::vector<std::string>& words) {
  std::string result;
  for (const std::string& word : words) result += (result.empty() ? "" : ", ") + word;
  return result;
}

// Lines of at most `width` characters that begin with `indent` blanks; the first begins with `head`.
std::string wrapped(const std::string& head, const std::string& words, std::size_t indent) {
  std::string line = std::string(indent, ' ') + head, result;
  bool fresh = head.empty();
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    const std::string word = words.substr(at, end - at);
    if (!fresh && line.size() + 1 + word.size() > width) {
      result += line + "\n";
      line = std::string(indent + 2, ' ');
      fresh = true;
    }
    line += (fresh ? "" : " ") + word;
    fresh = false;
    at = end + 1;
  }
  return result + line + "\n";
}

// An equation as lines that fit a terminal of 80 columns beside the margin of a page.
std::string folded(const std::string& equation) {
  constexpr std::size_t page_width = 64;
  std::string lines, line;
  std::istringstream words(equation);
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > page_width) {
      lines += line + "\n";
      line = " ";
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line + "\n";
}

std::string usual(const Parameter& p, const std::string& before) {
  if (p.typical == 0) return "";
  return before + number(p.typical) + (p.unit.empty() || p.unit == "1" ? "" : " " + p.unit);
}

std::string parameter_in_words(const Parameter& p) {
  const std::string unit = p.unit.empty() || p.unit == "1" ? "" : " " + p.unit;
  return p.name + ": " + p.meaning + "; " + number(p.lower) + " to " + number(p.upper) + unit + ", neutral at " +
         number(p.neutral) + usual(p, ", usually off by ");
}

std::string domains_in_words(const Mechanism& m) {
  return m.domains.empty() ? "no hypothesis of explain yet; render applies it" : joined(m.domains);
}

}  // namespace

std::vector<Stage> by_stage() {
  std::vector<Stage> result;
  for (const auto& [name, sentence] : stages) result.push_back({name, sentence, {}});
  for (const Mechanism* m : all_mechanisms()) {
    auto found = std::find_if(result.begin(), result.end(), [&](const Stage& s) { return s.name == m->stage; });
    if (found == result.end()) {
      result.push_back({m->stage, m->stage, {}});
      found = result.end() - 1;
    }
    found->mechanisms.push_back(m);
  }
  std::erase_if(result, [](const Stage& s) { return s.mechanisms.empty(); });
  return result;
}

std::string text() {
  std::string result;
  for (const Stage& stage : by_stage()) {
    result += (result.empty() ? "" : "\n") + stage.sentence + "\n";
    for (const Mechanism* m : stage.mechanisms) {
      result += "\n" + m->id + "\n" + wrapped("", m->sentence, 4);
      if (!m->typical.empty()) result += wrapped("size:", m->typical, 4);
      result += wrapped("equation:", m->equation, 4);
      for (const Parameter& p : m->parameters) result += wrapped("", parameter_in_words(p), 4);
      result += wrapped("hypothesis for:", domains_in_words(*m), 4);
      result += wrapped("seen in:", joined(m->conditions), 4);
      for (const Confusion& c : m->mistaken_for)
        result += wrapped("mistaken for " + c.with + ", told apart by:", c.told_apart, 4);
    }
  }
  return result;
}

std::string markdown() {
  std::string result;
  for (const Stage& stage : by_stage()) {
    std::string heading = stage.sentence.substr(0, stage.sentence.find(':'));
    std::transform(heading.begin(), heading.end(), heading.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    result += "# " + heading + "\n";
    const std::size_t colon = stage.sentence.find(": ");
    if (colon != std::string::npos) {
      std::string rest = stage.sentence.substr(colon + 2);
      rest[0] = static_cast<char>(rest[0] >= 'a' && rest[0] <= 'z' ? rest[0] - 'a' + 'A' : rest[0]);
      result += rest + ".\n\n";
    }
    for (const Mechanism* m : stage.mechanisms) {
      result += "## " + m->id + "\n" + m->sentence;
      if (!m->typical.empty()) result += " Typical size: " + m->typical + ".";
      result += "\n\n```\n" + folded(m->equation) +
                "```\n\n| parameter | unit | neutral | bounds | usual deviation | meaning |\n";
      for (const Parameter& p : m->parameters)
        result += "| " + p.name + " | " + p.unit + " | " + number(p.neutral) + " | " + number(p.lower) + " to " +
                  number(p.upper) + " | " + usual(p, "") + " | " + manifest::in_cell(p.meaning) + " |\n";
      if (m->lists)
        result += "\nIn a manifest these are lists of one length: an entry for each thing that it tells of.\n";
      result += "\nHypothesis for: " + domains_in_words(*m) + ". Shows in: " + joined(m->conditions) + ".\n";
      for (const Confusion& c : m->mistaken_for)
        result += "- mistaken for **" + c.with + "**; told apart by: " + c.told_apart + "\n";
      result += "\nSource: " + m->source + "\n\n";
    }
  }
  return result;
}

}  // namespace gonio::mechanism
