// hdr/flea3 as a table of grey levels on standard output: see tests/explain/tables/flea3.h.
#include <iostream>

#include "explain/tables/flea3.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "prove-flea3 FOLDER\n";
    return 64;
  }
  try {
    std::cout << gonio::tests::flea3_csv(argv[1]);
  } catch (const std::exception& e) {
    std::cerr << "prove-flea3: " << e.what() << "\n";
    return 65;
  }
}
