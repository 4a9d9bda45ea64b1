// The controller of a simulated arm as its network sees it: RTDE (protocol 2), the secondary interface with the part of
// URScript that moves arms (def .. end, movej, stopj, write_output_integer_register), the dashboard server's questions.
// Written from the makers' pages alone: no line is shared with the client that talks to it.
#pragma once
#include <string>
#include <vector>

#include "acquisition/desk/faults.h"
#include "acquisition/desk/socket_server.h"
#include "acquisition/desk/true_arm.h"

namespace gonio::acquisition::desk {

struct UrPorts {  // 0: any that is free
  int rtde = 0, script = 0, dashboard = 0;
};

class UrController {
 public:
  UrController(TrueArm& arm, Faults& faults, const UrPorts& ports = {});
  int rtde_port() const { return rtde_.port(); }
  int script_port() const { return script_.port(); }
  int dashboard_port() const { return dashboard_.port(); }

 private:
  SocketServer rtde_, script_, dashboard_;
};

// For one connection each.
void serve_rtde(Peer& peer, TrueArm& arm, Faults& faults);
void serve_script(Peer& peer, TrueArm& arm, Faults& faults);
void serve_dashboard(Peer& peer, TrueArm& arm);

// Nothing where the text is no program of the part that is known.
std::vector<ArmStep> steps_of_script(const std::string& program);
// One RTDE data packet of these fields, and the types that are answered for them ("NOT_FOUND" where there is none).
std::string rtde_data_bytes(const ArmSnapshot& arm, const std::vector<std::string>& names);
std::string rtde_types(const std::vector<std::string>& names);

}  // namespace gonio::acquisition::desk
