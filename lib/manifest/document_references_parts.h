// Parts of document_references.cpp: names that must exist. Private to manifest/.
#pragma once
#include <map>
#include <string>

#include "base/error.h"
#include "manifest/document.h"

namespace gonio::manifest {

template <class T>
void must_exist(const std::map<std::string, T>& section, const std::string& section_name, const std::string& key,
                const std::string& where) {
  if (key.empty() || section.contains(key)) return;
  std::string names;
  for (const auto& [name, entry] : section) names += (names.empty() ? "" : ", ") + name;
  throw Error(Exit::data, where, "names \"" + key + "\", which is not in " + section_name,
              names.empty() ? "that section is empty"
                            : "there is " + (names.size() > 80 ? names.substr(0, 77) + "..." : names));
}

void check_alignments(const Document& d);
void check_prints(const Document& d);

}  // namespace gonio::manifest
