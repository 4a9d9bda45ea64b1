// What declarations of knobs are made with. Private to traced/.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "explain/traced/knobs.h"
#include "manifest/document.h"

namespace gonio::explain::traced {

// What the surface has in the scene, of a number that its model has.
std::vector<double> stated_of(const scene::Surface& surface, const std::string& name);

class KnobBuilder {
 public:
  KnobBuilder(const manifest::Document& document, const relighting::Recordings& recordings, const scene::Scene& scene)
      : document_(document), recordings_(recordings), scene_(scene) {}

  std::size_t respond(std::vector<double> nodes, double stated, std::function<void(manifest::Document&, double)> set);
  std::size_t knob(Parameter parameter, Acts acts, std::size_t response, int channel = -1, std::size_t surface = 0);
  Question& ask(const mechanism::Mechanism* mechanism, std::vector<std::string> on, std::vector<std::size_t> knobs);
  static Parameter of(const mechanism::Parameter& m, const std::string& before);
  static void within_nodes(Parameter& p, const std::vector<double>& nodes);

  // What light does in the thing and on its surface, asked of the surface in question number `a`.
  void of_surface(std::size_t a);

 protected:
  const manifest::Document& document_;
  const relighting::Recordings& recordings_;
  const scene::Scene& scene_;
  Knobs all_;

 private:
  void absorption(const scene::Surface& surface);
  void index(const scene::Surface& surface);
  void directional(const scene::Surface& surface);
  void roughness(std::size_t a);
};

}  // namespace gonio::explain::traced
