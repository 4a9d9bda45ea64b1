// See listing.h.
#include "nrsfm/solve/listing.h"

#include <cctype>

#include "base/text.h"
#include "manifest/reference.h"
#include "nrsfm/make/animatronic.h"
#include "nrsfm/solve/solver.h"

namespace gonio::nrsfm {
namespace {

std::string tracks_taken(const SolverInfo& info) {
  return info.takes_missing ? "missing tracks" : "complete tracks only";
}

std::string cameras_taken(const SolverInfo& info) {
  if (info.orthographic && info.perspective) return "cameras of all kinds";
  return info.perspective ? "pinhole cameras" : "orthographic and weak-perspective cameras";
}

}  // namespace

std::string list_of_solvers() {
  std::string text;
  for (const Solver* solver : all_solvers()) {
    const SolverInfo& info = solver->info();
    text += info.id + ": " + info.title + "\n  " + info.sentence + "\n  " + info.source + "\n  takes " +
            tracks_taken(info) + "; " + cameras_taken(info) + "\n";
    for (const SolverParameter& p : info.parameters)
      text += "    " + p.name + "=" + shortest_text(p.preset) + "  (" + shortest_text(p.lower) + " .. " +
              shortest_text(p.upper) + ") " + p.meaning + "\n";
  }
  return text;
}

std::string markdown() {
  std::string text = "# SOLVERS\n";
  for (const Solver* solver : all_solvers()) {
    const SolverInfo& info = solver->info();
    std::string title = info.title;
    title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
    text += "## " + info.id + "\n" + title + ". " + info.sentence + " Takes " + tracks_taken(info) + "; " +
            cameras_taken(info) + ".\n\n| parameter | preset | bounds | meaning |\n";
    for (const SolverParameter& p : info.parameters)
      text += "| " + p.name + " | " + shortest_text(p.preset) + " | " + shortest_text(p.lower) + " to " +
              shortest_text(p.upper) + " | " + manifest::in_cell(p.meaning) + " |\n";
    text += "\nSource: " + info.source + "\n\n";
  }
  text += "# ANIMATRONICS\n";
  for (const Animatronic* animatronic : all_animatronics()) {
    const AnimatronicInfo& info = animatronic->info();
    text += "## " + info.id + "\n" + info.sentence + "\n\nSource: " + info.source + "\n\n";
  }
  return text;
}

}  // namespace gonio::nrsfm
