#include "slurm/cluster.h"

#include <arpa/inet.h>
#include <sys/prctl.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "base/atomic_file.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;

// Free on loopback now, all of them different.
std::array<int, 3> free_ports() {
  std::array<int, 3> ports{}, sockets{};
  for (std::size_t i = 0; i < ports.size(); ++i) {
    sockets[i] = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* plain = reinterpret_cast<sockaddr*>(&address);
    if (::bind(sockets[i], plain, size) != 0 || ::getsockname(sockets[i], plain, &size) != 0)
      throw std::runtime_error("no free port");
    ports[i] = ntohs(address.sin_port);
  }
  for (const int socket : sockets) ::close(socket);
  return ports;
}

std::string short_host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  const std::string whole = name;
  return whole.substr(0, whole.find('.'));
}

// One processor a node: what runs at the same time runs on different nodes. Arrays have five elements at most.
std::string configuration(const fs::path& folder, int node_timeout_s) {
  const auto ports = free_ports();
  const std::string host = short_host_name();
  std::ostringstream out;
  out << "ClusterName=gonio\nSlurmctldHost=" << host << "(127.0.0.1)\nSlurmUser=root\nAuthType=auth/munge\n"
      << "AuthInfo=socket=" << (folder / "munge").string() << "\nSlurmctldPort=" << ports[0]
      << "\nStateSaveLocation=" << (folder / "state").string() << "\nSlurmdSpoolDir=" << (folder / "spool-%n").string()
      << "\nSlurmctldPidFile=" << (folder / "slurmctld.pid").string()
      << "\nSlurmdPidFile=" << (folder / "slurmd-%n.pid").string()
      << "\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nMpiDefault=none\n"
         "JobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none\n"
         "SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nSlurmdParameters=config_overrides\n"
         "SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0,bf_interval=1\n"
         "KillWait=3\nMessageTimeout=5\nMaxArraySize=5\nSlurmdTimeout="
      << node_timeout_s << "\n";
  for (const int node : {1, 2})
    out << "NodeName=n" << node << " NodeHostname=" << host
        << " NodeAddr=127.0.0.1 CPUs=1 RealMemory=500 Port=" << ports[static_cast<std::size_t>(node)] << "\n";
  out << "PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP\n";
  return out.str();
}

// "NAME=VALUE" as in the environment that a process began with.
bool has_variable(const fs::path& process, const std::string& variable) {
  std::ifstream in(process / "environ", std::ios::binary);
  std::string entry;
  while (std::getline(in, entry, '\0'))
    if (entry == variable) return true;
  return false;
}

pid_t parent_of(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string line, state;
  std::getline(in, line);
  std::istringstream rest(line.substr(std::min(line.size(), line.rfind(')') + 1)));
  pid_t parent = 0;
  rest >> state >> parent;
  return parent;
}

bool is_stepd(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/comm");
  std::string name;
  std::getline(in, name);
  return name.starts_with("slurmstepd");
}

}  // namespace

Cluster::Cluster(const fs::path& folder, int node_timeout_s) : folder_(folder) {
  if (::geteuid() != 0) {
    missing_ = "munged and slurmd want to be root";
    return;
  }
  for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch"})
    if (run({"env", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "which", program}).status != 0) {
      missing_ = std::string(program) + " is not installed: scripts/setup";
      return;
    }
  fs::create_directories(folder / "state");
  start_daemons(node_timeout_s);
  const auto idle = [this] {
    Process::Words words = environment();
    for (const char* word : {"sinfo", "-h", "-N", "-o", "%T"}) words.emplace_back(word);
    return run(words).out == "idle\nidle\n";
  };
  for (int k = 0; k < 150; ++k) {
    if (idle()) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  missing_ = "the cluster does not come up";
  for (auto& daemon : daemons_) {
    ::kill(daemon->id(), SIGKILL);
    missing_ += "\n" + daemon->end().err;
  }
  daemons_.clear();
}

void Cluster::start_daemons(int node_timeout_s) {
  write_file(folder_ / "slurm.conf", configuration(folder_, node_timeout_s));
  std::string key(128, '\0');
  std::random_device random;
  for (char& byte : key) byte = static_cast<char>(random());
  write_file(folder_ / "key", key);
  fs::permissions(folder_ / "key", fs::perms::owner_read | fs::perms::owner_write);
  const auto in_folder = [this](const char* option, const char* name) { return option + (folder_ / name).string(); };
  start({"munged", "--force", "--foreground", in_folder("--key-file=", "key"), in_folder("--socket=", "munge"),
         in_folder("--pid-file=", "munge.pid"), in_folder("--log-file=", "munge.log"),
         in_folder("--seed-file=", "munge.seed")});
  for (int k = 0; k < 100 && !fs::exists(folder_ / "munge"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  start({"slurmctld", "-D", "-c"});
  for (const int node : {0, 1}) nodes_[node] = start({"slurmd", "-D", "-N", "n" + std::to_string(node + 1)}).id();
}

Process& Cluster::start(const Process::Words& words) {
  Process::Words all = environment();
  all.insert(all.end(), words.begin(), words.end());
  daemons_.push_back(std::make_unique<Process>(all, folder_, "", [] { ::prctl(PR_SET_PDEATHSIG, SIGKILL); }));
  return *daemons_.back();
}

Process::Words Cluster::environment() const {
  return {"env", "SLURM_CONF=" + (folder_ / "slurm.conf").string(),
          std::string("PATH=") + GONIO_BIN + ":/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"};
}

// Jobs of a node (all nodes: ""), before them the slurmstepd that run them, which would report their end.
std::vector<pid_t> Cluster::ours(const std::string& node) const {
  std::vector<pid_t> jobs, steps;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (!has_variable(entry.path(), "SLURM_CONF=" + (folder_ / "slurm.conf").string())) continue;
    const auto id = static_cast<pid_t>(std::stol(name));
    if (!node.empty() && !has_variable(entry.path(), "SLURMD_NODENAME=" + node)) continue;
    jobs.push_back(id);
    if (const pid_t parent = parent_of(id); is_stepd(parent)) steps.push_back(parent);
  }
  steps.insert(steps.end(), jobs.begin(), jobs.end());
  return steps;
}

void Cluster::lose_node(const std::string& name) {
  ::kill(nodes_[name == "n1" ? 0 : 1], SIGKILL);
  for (int k = 0; k < 3; ++k)
    for (const pid_t id : ours(name)) ::kill(id, SIGKILL);
}

Cluster::~Cluster() {
  for (auto& daemon : daemons_) ::kill(daemon->id(), SIGKILL);
  for (auto& daemon : daemons_) daemon->end();
  for (int k = 0; k < 50; ++k) {
    const auto left = ours("");
    if (left.empty()) return;
    for (const pid_t id : left) ::kill(id, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace gonio::tests
