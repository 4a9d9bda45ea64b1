#include "explain/domain_listing.h"

#include <algorithm>
#include <sstream>

namespace gonio::explain {
namespace {

std::string joined(const std::vector<std::string>& ids) {
  std::string all;
  for (const std::string& id : ids) all += (all.empty() ? "" : ", ") + id;
  return all;
}

// Lines of a hundred characters; those after the first two blanks further in.
std::string wrapped(const std::string& words, std::size_t indent) {
  constexpr std::size_t width = 100;
  std::string lines, line(indent, ' ');
  std::istringstream in(words);
  bool fresh = true;
  for (std::string word; in >> word; fresh = false) {
    if (!fresh && line.size() + 1 + word.size() > width) {
      lines += line + "\n";
      line = std::string(indent + 2, ' ');
      fresh = true;
    }
    line += (fresh ? "" : " ") + word;
  }
  return lines + line + "\n";
}

}  // namespace

bool is_asked(const Domain& domain, const mechanism::Mechanism& mechanism) {
  return std::ranges::count(mechanism.domains, domain.name) > 0;
}

const Untouched* untouched(const Domain& domain, const mechanism::Mechanism& mechanism) {
  const Untouched* best = nullptr;
  for (const Untouched& one : domain.untouched) {
    if (one.ids.ends_with('.') ? !mechanism.id.starts_with(one.ids) : mechanism.id != one.ids) continue;
    if (best == nullptr || one.ids.size() > best->ids.size()) best = &one;
  }
  return best;
}

std::vector<DomainRow> product() {
  std::vector<DomainRow> rows;
  for (const Domain* domain : all_domains()) {
    DomainRow row{domain, {}, {}, {}};
    for (const mechanism::Mechanism* m : mechanism::all_mechanisms()) {
      if (is_asked(*domain, *m)) {
        row.asked.push_back(m->id);
        continue;
      }
      const Untouched* reason = untouched(*domain, *m);
      if (reason == nullptr) {
        row.missing.push_back(m->id);
        continue;
      }
      const auto same = std::ranges::find(row.not_asked, reason->why, &DomainRow::Reason::why);
      if (same != row.not_asked.end())
        same->ids.push_back(m->id);
      else
        row.not_asked.push_back({reason->why, {m->id}});
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string product_text() {
  std::string text;
  for (const DomainRow& row : product()) {
    text += (text.empty() ? "" : "\n") + row.domain->name + "\n" + wrapped(row.domain->sentence, 4);
    text += wrapped("asked: " + joined(row.asked), 4);
    for (const DomainRow::Reason& reason : row.not_asked)
      text += wrapped("not asked, " + reason.why + ": " + joined(reason.ids), 4);
  }
  return text;
}

std::string product_markdown() {
  std::string text = "# WHAT IS ASKED OF WHICH RECORDINGS\n";
  for (const DomainRow& row : product()) {
    text +=
        "## " + row.domain->name + "\nRecordings: " + row.domain->sentence + ".\n\nAsked: " + joined(row.asked) + ".\n";
    if (!row.not_asked.empty()) text += "\nNot asked:\n";
    for (const DomainRow::Reason& reason : row.not_asked) text += "- " + joined(reason.ids) + ": " + reason.why + "\n";
    text += "\n";
  }
  return text;
}

}  // namespace gonio::explain
