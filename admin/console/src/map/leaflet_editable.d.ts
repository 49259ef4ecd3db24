declare module 'leaflet-editable';
