#include "transport/fast_dds/live_type.hpp"

#include <fastrtps/types/TypeObjectFactory.h>

#include <mutex>

// Puts names of Fast DDS into the global namespace, where those of Eigen do not go with them: this file is compiled
// alone.
#include "hybridtestTypeObject.h"

namespace hybridtest::fast_dds {

void describe_live_type() {
  static std::once_flag once;
  std::call_once(once, [] {
    constexpr const char* kType = "hybridtest::wire::SignalBlock";
    auto* factory = eprosima::fastrtps::types::TypeObjectFactory::get_instance();
    for (const bool is_complete : {true, false}) {
      factory->add_type_object(kType, wire::GetSignalBlockIdentifier(is_complete),
                               wire::GetSignalBlockObject(is_complete));
    }
  });
}

}  // namespace hybridtest::fast_dds
