#pragma once

namespace hybridtest::fast_dds {

/// From the first call on, writers of live signals publish the XTypes description of their message, so that other DDS
/// programs read them without our IDL. The other topics have none: they are for participants alone, and Fast DDS 2.9.1
/// crashes in a program that learns a type with a structure inside.
void describe_live_type();

}  // namespace hybridtest::fast_dds
