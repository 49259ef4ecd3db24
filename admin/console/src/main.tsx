import { render } from 'preact';
import 'leaflet/dist/leaflet.css';
import './style/tokens.css';
import './style/parts.css';
import './style/layout.css';
import './style/map.css';
import { Console } from './console';
import { applyTheme } from './theme';

applyTheme();
render(<Console />, document.getElementById('console')!);
