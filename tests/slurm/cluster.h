// A Slurm cluster of one machine's own: munged, slurmctld and two slurmd, n1 and n2, with one processor each, on
// loopback, with ports, key and files that nobody else has. Ends with the object, jobs included; daemons end with the
// process, too. Needs root, since munged and slurmd do.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "process.h"

namespace gonio::tests {

class Cluster {
 public:
  // A node that does not answer for node_timeout_s counts as lost; long, so that a busy machine loses none by accident.
  explicit Cluster(const std::filesystem::path& folder, int node_timeout_s = 120);
  ~Cluster();
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  // Empty once both nodes are idle; else why there is no cluster.
  const std::string& missing() const { return missing_; }
  // For commands that talk to this cluster, and find the built programs.
  Process::Words environment() const;
  // As a power cut does: the node's slurmd, its jobs and what they run are gone at once.
  void lose_node(const std::string& name);

 private:
  void start_daemons(int node_timeout_s);
  Process& start(const Process::Words& words);
  std::vector<pid_t> ours(const std::string& node) const;

  std::filesystem::path folder_;
  std::string missing_;
  std::vector<std::unique_ptr<Process>> daemons_;
  pid_t nodes_[2] = {0, 0};
};

}  // namespace gonio::tests
