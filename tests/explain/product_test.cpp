// Every mechanism by every domain: a hypothesis there, or refused with a reason. Nobody keeps the table: mechanisms say
// where they are asked, domains why they do not ask.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "explain/domain_listing.h"
#include "surface/surface.h"

namespace gonio::explain {
namespace {

using mechanism::Mechanism;

TEST(Product, EveryMechanismIsAskedOfEveryRecordingOrRefusedWithAReason) {
  for (const DomainRow& row : product())
    for (const std::string& id : row.missing)
      ADD_FAILURE() << id << " is no hypothesis for " << row.domain->name
                    << ", and nothing says why: bind it and add \"" << row.domain->name
                    << "\" to its domains, or give the reason in lib/explain/domains/" << row.domain->name << ".cpp";
}

TEST(Product, ADomainThatIsDeclaredExists) {
  for (const Mechanism* m : mechanism::all_mechanisms())
    for (const std::string& name : m->domains)
      EXPECT_TRUE(std::ranges::any_of(all_domains(), [&](const Domain* d) { return d->name == name; }))
          << m->id << " says \"" << name << "\"";
}

// A reason that speaks of one mechanism goes when that is asked; one that speaks of many, when none is left.
TEST(Product, ReasonsAreSentencesThatAreNeeded) {
  for (const Domain* domain : all_domains()) {
    std::set<std::string> seen;
    for (const Untouched& one : domain->untouched) {
      EXPECT_TRUE(seen.insert(one.ids).second) << domain->name << ": two reasons for " << one.ids;
      EXPECT_GT(one.why.size(), 8U) << domain->name << ": " << one.ids;
      bool needed = false;
      for (const Mechanism* m : mechanism::all_mechanisms())
        needed |= untouched(*domain, *m) == &one && !is_asked(*domain, *m);
      EXPECT_TRUE(needed) << domain->name << ": nothing is left that \"" << one.ids << "\" speaks of";
    }
  }
}

// Declared and bound: a file of a folder of bindings stands for a domain, and a declaration for a binding.
TEST(Product, WhatIsDeclaredIsBoundAndWhatIsBoundIsDeclared) {
  const std::multimap<std::string, std::string> folders = {
      {"images", "lib/relighting/terms"},           {"tables", "lib/explain/tables/terms"},
      {"tables", "lib/explain/tables/reflectance"}, {"stacks", "lib/explain/stacks/exposures"},
      {"stacks", "lib/explain/stacks/lights"},      {"volumes", "lib/explain/volumes/terms"},
      {"prints", "lib/explain/prints/terms"},       {"polarization", "lib/explain/polarization/terms"}};
  std::map<std::string, std::set<std::string>> bound;  // by domain
  for (const auto& [domain, folder] : folders)
    for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(GONIO_SOURCE) / folder))
      bound[domain].insert(file.path().stem().string());
  const auto expressed = [](const Mechanism& m) {  // by the rule of relighting/surface_rule.h
    return m.target == mechanism::Target::surface &&
           std::ranges::any_of(surface::all_models(), [&](const surface::Model* model) {
             return std::ranges::all_of(m.parameters, [&](const mechanism::Parameter& p) {
               return std::ranges::count(model->info().parameters, p.name, &manifest::ParameterInfo::name) > 0;
             });
           });
  };
  for (const Mechanism* m : mechanism::all_mechanisms()) {
    std::string stem = m->id;
    for (char& c : stem)
      if (c == '.' || c == '-') c = '_';
    const auto declared = [&](const char* domain) { return std::ranges::count(m->domains, domain) > 0; };
    for (const auto& [domain, stems] : bound)
      EXPECT_TRUE(declared(domain.c_str()) || !stems.contains(stem)) << m->id << " is bound in " << domain;
    for (const char* domain : {"images", "stacks", "volumes", "polarization"})
      EXPECT_TRUE(!declared(domain) || bound[domain].contains(stem) ||
                  (std::string(domain) == "images" && expressed(*m)))
          << m->id << " says " << domain << " and is bound to nothing there";
  }
}

TEST(Product, IsPrintedWhole) {
  const std::string text = product_text(), page = product_markdown();
  for (const Domain* domain : all_domains()) {
    EXPECT_THAT(text, testing::HasSubstr(domain->name + "\n    ")) << domain->name;
    EXPECT_THAT(page, testing::HasSubstr("## " + domain->name + "\n"));
  }
  for (const Mechanism* m : mechanism::all_mechanisms()) EXPECT_THAT(page, testing::HasSubstr(m->id));
}

}  // namespace
}  // namespace gonio::explain
