// See report.h.
#include "inference/report.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "inference/report_parts.h"

namespace gonio::inference {
namespace {

report::Tone tone_of(Verdict verdict) {
  if (verdict == Verdict::unknown) return report::Tone::bad;
  return verdict == Verdict::named ? report::Tone::good : report::Tone::neutral;
}

// The first sentence, and what follows it.
std::pair<std::string, std::string> first_sentence(const std::string& text) {
  for (std::size_t at = text.find(". "); at != std::string::npos; at = text.find(". ", at + 1))
    if (at + 2 < text.size() && std::isupper(static_cast<unsigned char>(text[at + 2])) != 0)
      return {text.substr(0, at + 1), text.substr(at + 2)};
  return {text, ""};
}

// "board.warp is left out", for pages about several kinds of recordings.
std::string short_answer(const ReportPart& part) {
  const Explanation& e = *part.explanation;
  if (!e.misplaced.files.empty()) return "files that belong to other pictures";
  if (e.verdict == Verdict::unknown) return "a mismatch that nothing in the library repairs";
  if (e.named.empty()) return "nothing that matters is left out";
  std::string ids;
  for (std::size_t k = 0; k < e.named.size(); ++k)
    ids += (k == 0 ? "" : k + 1 == e.named.size() ? " and " : ", ") + part.problem->candidates()[e.named[k]].id();
  return ids + (e.named.size() == 1 ? " is left out" : " are left out");
}

void tell_part(report::Page& page, const ReportPart& part, bool alone) {
  if (!alone) {
    page.section("What was found: " + part.problem->domain());
    page.paragraph(part.explanation->sentence);
  }
  tell_misplaced(page, part);
  const bool law_first = part.explanation->verdict == Verdict::unknown;
  tell_where(page, part);
  tell_curve(page, part);
  if (law_first) tell_law(page, part);
  tell_sure(page, part);
  tell_next(page, part);
  if (!law_first) tell_law(page, part);
  tell_rest(page, part);
}

}  // namespace

std::string report_page(const std::string& name, const std::vector<ReportPart>& parts) {
  std::string headline, lead;
  Verdict worst = Verdict::null;
  for (const ReportPart& p : parts) {
    headline += (headline.empty() ? "" : "; ") + p.problem->domain() + ": " + short_answer(p);
    lead += (lead.empty() ? "" : "; ") + std::to_string(p.problem->observations().groups()) + " " +
            p.problem->group_noun() + "s, " + std::to_string(p.problem->observations().rows()) + " observations";
    worst = std::max(worst, p.explanation->verdict);
  }
  if (parts.size() == 1) {
    const auto [first, rest] = first_sentence(parts[0].explanation->sentence);
    headline = first;
    if (!rest.empty()) lead = rest + " (" + lead + ")";
  }
  report::Page page("explain: " + std::filesystem::path(name).filename().string(), headline, lead, tone_of(worst));
  for (const ReportPart& p : parts) tell_part(page, p, parts.size() == 1);
  page.footer(
      "Written by gonio explain. Scores are of groups that the fit did not see; intervals hold under correlation "
      "inside blocks.");
  return page.html();
}

}  // namespace gonio::inference
