# Writes a header of core as others include it. Usage: cmake -DFROM=... -DTO=... -P public_header.cmake
file(READ "${FROM}" text)
string(REPLACE "#include \"core/" "#include \"fairway/core/" text "${text}")
file(WRITE "${TO}" "${text}")
