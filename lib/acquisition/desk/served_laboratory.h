// The simulated laboratory behind its network: for every arm a controller (RTDE, secondary interface, dashboard, Modbus
// registers), lamps and turntables behind one Modbus server, cameras of GigE Vision, all on loopback. What stands there
// is what the in-process laboratory has (true_laboratory.h): a run over the network takes the same pictures. Nothing of
// the truth leaves it but by its devices.
//
// A stopped arm is released as a real one is, by its dashboard: "unlock protective stop".
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "acquisition/desk/faults.h"
#include "acquisition/desk/true_laboratory.h"

namespace gonio::acquisition {

struct ServeOptions {
  DeskOptions desk;
  double pace = 1;  // how much faster than ours its time runs
  int port = 0;     // the first of the ports, which follow one another; 0: any that are free
  std::vector<std::pair<desk::Fault, double>> faults;  // with their probabilities
};

// "rtde-dropped=1%,lamp-dark=0.02". Error(usage) at `place`, with the names that there are.
std::vector<std::pair<desk::Fault, double>> parse_faults(const std::string& text, const std::string& place);
std::string fault_list();  // for people: "rtde-dropped, an arm's data packet is not sent; ..."

class ServedLaboratory {
 public:
  // `scene`: what stands in the laboratory, or none: its objects, surfaces, lights, ... take the place of the
  // description's. Error(data) for devices that cannot be served, Error(unavailable) where a port is taken.
  ServedLaboratory(const manifest::Document& believed, const manifest::Document* scene, const manifest::Document* truth,
                   const ServeOptions& options);
  ~ServedLaboratory();
  ServedLaboratory(const ServedLaboratory&) = delete;
  ServedLaboratory& operator=(const ServedLaboratory&) = delete;

  manifest::Document description() const;  // what was believed, with the URLs that reach the servers
  std::vector<std::string> words() const;  // one line a device
  std::int64_t struck(desk::Fault) const;  // how often so far

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace gonio::acquisition
