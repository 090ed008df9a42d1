// Marches say here when they end before their work is done: some drivers cut the loops of a pixel, all turns counted
// together, without a word.
const int MARCH_LIMIT = 60000;
bool march_was_cut = false;
