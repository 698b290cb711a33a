/** What jsdom lacks of a browser: it neither decodes images nor lays anything out. */

import "fake-indexeddb/auto";
import { SHOWN } from "./drawn";

HTMLImageElement.prototype.decode = async () => {};
Element.prototype.getBoundingClientRect = () => SHOWN;
