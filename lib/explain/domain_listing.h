// Which mechanism is a hypothesis for which recordings, and why the others are not: the product of the registry and the
// domains, as explain --list --domains and gonio-mechanisms(7) print it. Both factors say it themselves:
// Mechanism::domains where one is asked, Domain::untouched why one is not.
#pragma once
#include <string>
#include <vector>

#include "explain/domain.h"
#include "mechanism/mechanism.h"

namespace gonio::explain {

bool is_asked(const Domain& domain, const mechanism::Mechanism& mechanism);
// The reason that stands for a mechanism, whether it is asked or not; null where nothing is said of it.
const Untouched* untouched(const Domain& domain, const mechanism::Mechanism& mechanism);

struct DomainRow {
  const Domain* domain = nullptr;
  std::vector<std::string> asked;  // ids
  struct Reason {
    std::string why;
    std::vector<std::string> ids;
  };
  std::vector<Reason> not_asked;     // in the domain's order
  std::vector<std::string> missing;  // neither asked nor refused in words
};
std::vector<DomainRow> product();  // one row for each domain, by name

std::string product_text();
std::string product_markdown();

}  // namespace gonio::explain
