// Names in the order in which they were first met.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace experiments {

class Names {
 public:
  /// Number of a name, new or old.
  std::size_t add(const std::string& name) {
    const auto [at, isNew] = index_.try_emplace(name, order_.size());
    if (isNew) order_.push_back(name);
    return at->second;
  }
  /// Number of a name that has been added.
  std::size_t operator[](const std::string& name) const { return index_.at(name); }
  bool has(const std::string& name) const { return index_.count(name) > 0; }
  const std::vector<std::string>& inOrder() const { return order_; }

 private:
  std::map<std::string, std::size_t> index_;
  std::vector<std::string> order_;
};

}  // namespace experiments
