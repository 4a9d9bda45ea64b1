// The micro-structure that gives a wished figure, with a relief of the patch that was simulated.
#include <algorithm>

#include "base/assignment.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/sections/relief.h"
#include "print/design.h"
#include "relief/document.h"
#include "relief/microstructure_use.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {

print::Wish wish_asked(const cli::Invocation& call) {
  const auto [name, value] = parse_assignment(call.text("wish"), "--wish", "type, say, sq=3um");
  const std::vector<std::string>& names = print::wished_figures();
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
    throw Error(Exit::usage, "--wish", "\"" + name + "\" is no figure that can be wished for", "wish for " + all);
  }
  print::Wish wish;
  wish.figure = static_cast<print::WishedFigure>(found - names.begin());
  const bool length = wish.figure == print::WishedFigure::sq || wish.figure == print::WishedFigure::sa;
  wish.value = parse_quantity(value, length ? Dimension::length : Dimension::ratio, "--wish");
  if (!(wish.value > 0)) throw Error(Exit::usage, "--wish", value + " is not above 0", "wish for more");
  wish.incidence_rad = call.number("incidence"), wish.view_rad = call.number("view");
  return wish;
}

bool fulfil_wish(Work& work) {
  cli::Invocation& call = work.call;
  const print::Wish wish = wish_asked(call);
  std::optional<manifest::MicrostructureUse> form;
  if (!call.texts("structure").empty())
    form = relief::parse_microstructure(call.texts("structure").front(), "--structure",
                                        [](const std::string&, const std::string&) { return false; });
  const print::Design design =
      print::design(work.printer, wish, ground_asked(work), form, std::max(2, static_cast<int>(call.integer("points"))),
                    call.seed, "--structure");
  const std::string figure = print::wished_figures()[static_cast<std::size_t>(wish.figure)];
  const bool length = wish.figure == print::WishedFigure::sq || wish.figure == print::WishedFigure::sa;
  const double scale = length ? 1e6 : 1;
  const char* unit = length ? " um" : "";
  manifest::Print& entry = work.entry();
  entry.microstructures = {{"wished", design.use}};
  entry.figures["wished_" + figure + (length ? "_m" : "")] = wish.value;
  entry.figures["reached_" + figure + (length ? "_m" : "")] = design.reached;
  entry.figures["sigma_" + figure + (length ? "_m" : "")] = design.sigma;
  const std::filesystem::path to = call.output_path("predicted.x3p");
  io::write_height_map(to, design.map);
  entry.relief = relief::enter_map(call.document, to, design.map);
  std::string parameters;
  for (const auto& [name, value] : design.use.parameters)
    parameters += (parameters.empty() ? "" : ",") + name + "=" + shortest_text(value.scalar());
  work.notes.push_back(format(
      "%s %.4g +- %.2g%s (wished %.4g%s) by --structure %s:%s; seen while %s was moved: %.4g to %.4g%s", figure.c_str(),
      design.reached * scale, design.sigma * scale, unit, wish.value * scale, unit, design.use.model.c_str(),
      parameters.c_str(), design.moved.c_str(), design.least * scale, design.most * scale, unit));
  log(design.met ? LogLevel::info : LogLevel::warning, work.notes.back());
  work.design = design;
  return design.met;
}

}  // namespace gonio::tools::dlp_slice
