// A surface of the manifest as the contrast experiment takes it: uniform over the sample, with the mechanisms that
// `render` would apply, its parameters free to be changed.
#pragma once
#include <memory>
#include <string>

#include "base/error.h"
#include "contrast/predict/experiment.h"
#include "manifest/model.h"
#include "manifest/sections/forward.h"

namespace gonio::contrast {

class Specimen {
 public:
  // Error(data) at the manifest's place for a surface that is not there, that varies over the object, or that lets
  // light through.
  Specimen(const manifest::Document& document, const std::string& surface);
  ~Specimen();
  Specimen(Specimen&&) noexcept;

  const std::string& name() const;
  const manifest::ModelInfo& info() const;
  const manifest::Parameters& parameters() const;  // as stated
  const manifest::Sigmas& sigma() const;
  const std::string& place() const;  // "scene.json#/surfaces/s"

  // The surface with these numbers in place of its own. Error(data) for what the model does not take.
  Reflectance with(const manifest::Parameters& changed) const;
  // A parameter's number (of a colour the mean), its preset where none is stated, and what the model says of it.
  // Error(usage) at `place` where the model has no such parameter.
  double number(const std::string& parameter, const std::string& place) const;
  const manifest::ParameterInfo& declared(const std::string& parameter, const std::string& place) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// What the model says of a parameter. Error(code) at `place` where it has none of that name.
const manifest::ParameterInfo& parameter_named(const manifest::ModelInfo& model, const std::string& name,
                                               const std::string& place, Exit code = Exit::usage);

}  // namespace gonio::contrast
