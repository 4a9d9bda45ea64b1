// glass-net behind its description: which photographs, what the network says of them, what is entered.
#pragma once
#include <string>
#include <vector>

#include "cli/program.h"
#include "io/image.h"

namespace gonio::tools::glass_net {

std::vector<cli::Option> options();
void check(cli::Invocation& call);
Exit run(cli::Invocation& call);

struct Looked {  // at one photograph; pixels are the network's
  std::string id;
  io::Image light;   // the first plane of what it saw
  io::Image answer;  // glass/net/answer.h, as_photographed
};
// What is worth a line: share of the pixels that show glass, medians of the uncertainties there.
std::string summary_of(const Looked& looked);
std::string page_of(const std::vector<Looked>& all, const std::string& weights);

}  // namespace gonio::tools::glass_net
