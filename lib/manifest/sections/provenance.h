// "provenance": which programs made the document, of what.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "manifest/value.h"

namespace gonio::manifest {

struct ProvenanceStep {
  std::string program, version;
  Value options = Value::object();
  std::vector<std::string> inputs;  // SHA-256 of the files that were read
  std::string manifest, after;      // content id of the manifest read; key of the step before
};
struct ProvenanceRun {  // of one step, where --stamp asked for it
  std::string time, host;
};
struct Provenance {
  std::map<std::string, ProvenanceStep> steps;
  std::string last;
  std::map<std::string, ProvenanceRun> runs;
};

}  // namespace gonio::manifest
